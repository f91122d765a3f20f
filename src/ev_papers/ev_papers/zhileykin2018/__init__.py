"""Zhileykin & Eranosyan (2018): drive torque of a 4x4 moved between axles and wheels."""
