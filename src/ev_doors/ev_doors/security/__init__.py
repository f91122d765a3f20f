"""Permissions of nodes as DDS security policies, and their check against a running graph."""
