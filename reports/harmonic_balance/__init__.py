"""The section on harmonic balance."""
