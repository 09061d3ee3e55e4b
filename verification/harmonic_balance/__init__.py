"""Tests of the harmonic balance."""
