"""Timings and accuracy runs of this project and of the peers, on the cases of verification.cases; each writes JSON."""
