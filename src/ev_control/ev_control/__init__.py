"""The control laws: electronic differential, power steering, torque vectoring, anti-slip regulation."""
