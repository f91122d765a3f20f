"""The node executable of the role asr."""

from ev_core.run_role import run_role


def main() -> None:
    """ros2 run ev_control asr"""
    run_role("asr")
