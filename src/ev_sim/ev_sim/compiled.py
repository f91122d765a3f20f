"""How every numerical function of the simulation is compiled."""

from numba import njit

# Compiled code is kept on disk. Division by zero gives infinity as in numpy, without a test at each division; sums
# keep the order in which they are written (no fastmath), so results are the same to the bit in every run.
compiled = njit(cache=True, error_model="numpy")
