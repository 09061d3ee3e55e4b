"""The sections on lines at rest: their accuracy, and error against run time."""
