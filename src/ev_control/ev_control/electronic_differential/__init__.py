"""Electronic differentials: how the torque of the driver is split between the wheels."""
