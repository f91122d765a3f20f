"""A CAN bus as nodes and models use it: channels, hub, log, arbitration, and the checks of a receiver."""
