"""The stack from Python, without ROS: `ev_sim.run`, `ev_sim.Simulation` and `ev_sim.batch` (docs/python.md)."""
