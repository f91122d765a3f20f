"""The node executables that are just their role, such as `ros2 run ev_control asr`."""

from ev_nodes.run_role import run_named_role

main = run_named_role
