"""Tests of response curves and of the stability of periodic responses."""
