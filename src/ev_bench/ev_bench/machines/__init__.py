"""The test bench: machines under test and load machines on shafts, with what measures them."""
