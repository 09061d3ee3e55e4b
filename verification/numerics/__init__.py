"""Tests of the numerical methods."""
