"""Truth tables of the conformance suite that take this project's solvers: lines and networks in motion."""
