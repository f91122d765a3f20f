"""Sensors that change the true numbers of a frame.

Noise, bias, quantisation, delay, drop-out (docs/sensors.md).
"""
