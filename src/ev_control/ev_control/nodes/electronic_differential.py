"""The node executable of the role electronic_differential."""

from ev_core.run_role import run_role


def main() -> None:
    """ros2 run ev_control electronic_differential"""
    run_role("electronic_differential")
