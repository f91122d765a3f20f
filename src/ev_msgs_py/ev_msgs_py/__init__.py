"""The contract: signals, topics, graph, vehicle description, parameters and the stepped node."""
