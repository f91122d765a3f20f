"""The node executable of the role steering_column."""

from ev_core.run_role import run_role


def main() -> None:
    """ros2 run ev_sim steering_column"""
    run_role("steering_column")
