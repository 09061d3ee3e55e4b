"""Conformance of this project and of other codes: the matrix, and scripts that reproduce what is wrong."""
