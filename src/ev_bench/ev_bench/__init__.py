"""The test bench: CAN bus, inverters, gateway, machines on shafts."""
