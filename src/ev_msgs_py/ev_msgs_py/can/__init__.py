"""CAN: what is on the bus, how it is written and guarded, how long it takes, and the adapters that carry it."""
