"""The moving cable of the HB paper on the box scheme, and its equilibrium."""
