"""The section on networks of lines."""
