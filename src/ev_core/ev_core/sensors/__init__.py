"""Sensors that change the true numbers of a frame: noise, bias, quantisation, delay, drop-out (docs/sensors.md)."""
