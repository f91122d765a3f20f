"""The parts of yaw moment control: motion as it is known, wanted motion, controllers, allocation to the wheels."""
