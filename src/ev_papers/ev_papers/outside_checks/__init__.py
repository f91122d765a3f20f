"""Checks against papers on torque vectoring of which the abstract alone could be read: their claims, on our cars."""
