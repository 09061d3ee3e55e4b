"""Tests of networks of lines at rest."""
