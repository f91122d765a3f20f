"""The node executable of the role test_bench."""

from ev_msgs_py.nodes.run_role import run_role


def main() -> None:
    """ros2 run ev_sim test_bench"""
    run_role("test_bench")
