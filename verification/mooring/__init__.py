"""Tests of the lumped mooring line: nodes with mass, weight and loads of half cells, joined by elastic cells."""
