"""Seeded defects: mistakes of the kinds people make, each planted in a copy of the project to see which checks find it.

`python -m verification.defects` runs the catalogue; `--help` tells the rest.
"""
