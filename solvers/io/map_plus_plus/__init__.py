"""Files of MAP++: read as networks, and written."""
