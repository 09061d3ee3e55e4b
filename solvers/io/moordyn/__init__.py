"""Files of MoorDyn: read as networks, and written."""
