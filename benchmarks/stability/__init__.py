"""Stability maps: where solvers break, and whether they say so."""
