"""Registers the traction controls."""

import ev_control.asr.acceleration_ratio
import ev_control.asr.adhesion_limit
import ev_control.asr.feedback_linearisation
import ev_control.asr.fuzzy
import ev_control.asr.least_squares
import ev_control.asr.least_squares_literal
import ev_control.asr.limp_home
import ev_control.asr.maximum_transmissible_torque
import ev_control.asr.off
import ev_control.asr.pi_slip
import ev_control.asr.slip_window  # noqa: F401
