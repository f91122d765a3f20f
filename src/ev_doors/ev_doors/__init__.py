"""Ways out of the stack: live page, export and FMU, Gymnasium, bridges, DDS security."""
