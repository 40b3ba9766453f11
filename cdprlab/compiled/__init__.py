"""What numba compiles: the loops that plain numpy is too slow for, each beside its equation."""
