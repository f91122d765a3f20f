"""Parts of yaw moment control: known motion, wanted motion, controllers, allocations."""
