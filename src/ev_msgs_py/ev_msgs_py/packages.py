"""The packages of this repository, each before those that import it."""

OURS = (
    "ev_msgs_py",
    "ev_core",
    "ev_nodes",
    "ev_control",
    "ev_sim",
    "ev_stack",
    "ev_bench",
    "ev_study",
    "ev_doors",
    "ev_papers",
)
