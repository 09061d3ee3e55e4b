"""The sections on claims and tests, seeded defects, other codes and the machine."""
