"""Drivelines: from motor torques to wheel torques."""
