"""What the bench adds to runs of the stack: its bus in real time, the log of its frames, metrics."""
