"""Plants: the car as it moves under wheel torques and the angle of its road wheels."""
