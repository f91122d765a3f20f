"""Contract of the nodes: signals, topics, roles, the frame, declared records."""
