"""Interface of the nodes: signals, topics, roles, frames, wire format, CAN frames."""
