"""Tests of the readers of input files."""
