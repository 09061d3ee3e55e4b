"""Tests of the report: what its pages say, and how it runs."""
