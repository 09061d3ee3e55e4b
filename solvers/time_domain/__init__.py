"""Time integration of a ChainSystem by the generalized-alpha method."""
