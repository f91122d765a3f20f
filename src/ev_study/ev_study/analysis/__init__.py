"""Linear models of the steering car, beside the simulated one."""
