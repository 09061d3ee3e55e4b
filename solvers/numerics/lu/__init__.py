"""LU of chains: banded for one instant, bordered block-bidiagonal for Fourier coefficients."""
