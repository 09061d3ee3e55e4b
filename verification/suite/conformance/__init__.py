"""Tests of the conformance cases: their command, verdicts, tables and published matrix."""
