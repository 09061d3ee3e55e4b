"""Small motions of moving lines about rest or a periodic motion: modes, impedance, steps over a period."""
