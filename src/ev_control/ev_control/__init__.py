"""Control laws: electronic differentials, power steering, torque vectoring, traction control."""
