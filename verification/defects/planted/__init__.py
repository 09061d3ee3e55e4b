"""Seeded defects, by problem type."""
