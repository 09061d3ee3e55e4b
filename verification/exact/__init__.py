"""Truth written another way: arbitrary precision, from the differential equations, sharing nothing with the solvers."""
