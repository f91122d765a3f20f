"""Traction control (acceleration slip regulation): what it lets through of the requested wheel torques."""
