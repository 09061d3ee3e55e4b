"""Numerical methods that know no mooring line: Newton, chains and their LU, Fourier series, modes, compiled loops."""
