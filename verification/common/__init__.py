"""Tests of what every room of solvers uses: outcomes, validation, motion."""
