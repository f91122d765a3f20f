"""Results of a run: its signals, in memory, as arrays on disk and as a bag."""
