"""The sections on papers, published values, other codes and seeded defects."""
