"""Motions of fairleads and bodies: harmonic, sampled, irregular, and those of sea states."""
