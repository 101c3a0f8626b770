"""The exact sums on a GPU, by numba-cuda. Imported only where one is asked for."""
