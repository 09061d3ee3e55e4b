"""Tests of tables of load cases."""
