"""Tests of the time integration."""
