"""A CAN bus for nodes and models: channels, hub, log, arbitration, and checks of a receiver."""
