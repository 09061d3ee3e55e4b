"""Periodic motions of moving lines: samples, harmonic balance, and Hill's problem."""
