"""Registers the traction controls."""

from ev_control.asr import (  # noqa: F401
    accelerations,
    adhesion_limit,
    blended_brakes,
    feedback_linearisation,
    least_squares,
    off,
    slip_control,
    slip_window,
    speed_set_points,
)
