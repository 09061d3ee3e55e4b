"""The sections on one line at rest."""
