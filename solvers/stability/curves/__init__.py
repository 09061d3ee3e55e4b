"""Response curves: continuation, special points, branches, and what sweeps in time say of them."""
