"""The section on moving cables."""
