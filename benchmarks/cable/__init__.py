"""Measurements of the moving cable: cases, orders, error against run time."""
