"""Inverters on a CAN bus with their machines: two under test, two that load them."""
