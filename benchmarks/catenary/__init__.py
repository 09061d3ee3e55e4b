"""Measurements of one line at rest: errors, run times, error against run time."""
