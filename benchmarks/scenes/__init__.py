"""Measurements of a user's own line, at rest and moving."""
