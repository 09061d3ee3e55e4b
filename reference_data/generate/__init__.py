"""Generators of the computed sets: a module a set, with COLUMNS, `design` and `compute`."""
