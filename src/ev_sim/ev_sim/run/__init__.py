"""Ways to drive a scenario: offline, all nodes in one process, every node its own process."""
