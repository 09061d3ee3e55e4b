"""Tables of numbers over time or frequency: columns, motions, seas."""
