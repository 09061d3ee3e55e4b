"""Truth of single lines: hanging, over a seabed, in small motion, and with manufactured loads."""
