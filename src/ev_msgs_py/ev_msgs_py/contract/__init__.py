"""What the nodes agree on: signals, topics, roles, the frame, declared records."""
