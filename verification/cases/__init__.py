"""Frozen case tables, one problem type a file; tests, benchmarks and the report read the same rows."""
