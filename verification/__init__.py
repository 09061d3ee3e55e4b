"""Verification: cases, exact references, and tests named by the question they ask."""
