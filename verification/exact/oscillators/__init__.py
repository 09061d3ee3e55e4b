"""Truth of oscillators: periodic motions, bifurcations, multipliers, basins."""
