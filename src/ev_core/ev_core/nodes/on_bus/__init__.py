"""Nodes that speak on a CAN bus."""
