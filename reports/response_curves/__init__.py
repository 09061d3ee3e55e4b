"""The sections on response curves and stability, of the report and of one's own line."""
