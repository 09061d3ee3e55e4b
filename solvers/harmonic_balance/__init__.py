"""Periodic response of a ChainSystem by multi-harmonic balance."""
