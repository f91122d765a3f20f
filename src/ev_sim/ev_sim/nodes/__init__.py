"""The nodes of the world; `main` is that of all of them, as in `ros2 run ev_sim plant`."""

from ev_nodes.run_role import run_named_role

main = run_named_role
