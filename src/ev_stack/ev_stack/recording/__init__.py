"""What a run leaves behind: its signals, in memory, as arrays on disk and as a bag."""
