"""The node executable of the role rear_steering."""

from ev_core.run_role import run_role


def main() -> None:
    """ros2 run ev_sim rear_steering"""
    run_role("rear_steering")
