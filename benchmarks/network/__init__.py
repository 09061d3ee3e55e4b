"""Measurements of networks of lines at rest."""
