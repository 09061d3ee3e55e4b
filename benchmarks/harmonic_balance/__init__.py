"""Measurements of the harmonic balance: the paper's figures and table, limits, growth."""
