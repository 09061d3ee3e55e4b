"""The section on stability maps."""
