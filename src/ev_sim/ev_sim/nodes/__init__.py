"""The nodes of the world; `main` is that of those that are just their role, as in `ros2 run ev_sim plant`."""

from ev_nodes.run_role import run_named_role

main = run_named_role
