"""Truth of networks at rest, of their small motions and of their symmetries."""
