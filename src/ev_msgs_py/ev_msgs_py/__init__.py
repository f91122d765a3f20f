"""What the nodes say to each other: signals, topics, roles, frames, wire format, CAN frames and their database."""
