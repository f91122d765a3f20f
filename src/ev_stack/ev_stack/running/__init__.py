"""Driving scenarios: offline, in one process, as processes."""
