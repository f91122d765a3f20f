"""Motors with their inverters, as the plant sees them: torque and electrical power."""
