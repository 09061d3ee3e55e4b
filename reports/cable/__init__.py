"""The section on the moving cable in time."""
