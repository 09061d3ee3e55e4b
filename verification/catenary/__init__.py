"""Tests of one elastic line at rest."""
