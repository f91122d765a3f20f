"""The bench's part in runs of the stack: its bus in real time, the log of its frames, metrics."""
