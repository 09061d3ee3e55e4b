"""Tests of the moving cable of the HB paper and of its equilibrium."""
