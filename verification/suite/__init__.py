"""Tests of the suite itself: architecture, documentation, report, published values, bad input of any kind."""
