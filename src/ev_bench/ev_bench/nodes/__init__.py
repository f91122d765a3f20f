"""The nodes of the bench: gateway, test bench, inverter."""
