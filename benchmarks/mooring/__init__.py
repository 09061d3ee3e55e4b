"""Measurements of moving lines of nodes and elements."""
