"""The node executable of the role driver."""

from ev_core.run_role import run_role


def main() -> None:
    """ros2 run ev_sim driver"""
    run_role("driver")
