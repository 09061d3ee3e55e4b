"""The section on moving lines of nodes and elements."""
