"""Reference values with their provenance: one folder a set, data.csv beside source.toml."""
