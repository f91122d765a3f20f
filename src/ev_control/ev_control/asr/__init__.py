"""Traction control (acceleration slip regulation): limits of the requested wheel torques."""
