"""The node executable of the role plant."""

from ev_core.run_role import run_role


def main() -> None:
    """ros2 run ev_sim plant"""
    run_role("plant")
