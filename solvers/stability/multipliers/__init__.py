"""Floquet multipliers: by Hill's problem, by a monodromy matrix, and the largest of long lines."""
