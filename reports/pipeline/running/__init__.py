"""Stages as child processes: their order, what the terminal shows, what the tests' own command leaves."""
