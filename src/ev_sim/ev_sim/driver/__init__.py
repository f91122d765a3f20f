"""Drivers: what the pedals and the hands on the steering wheel do."""
