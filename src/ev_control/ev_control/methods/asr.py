"""Registers the traction controls."""

import ev_control.asr.acceleration_ratio
import ev_control.asr.adhesion_limit
import ev_control.asr.blended_brakes
import ev_control.asr.expected_signal
import ev_control.asr.feedback_linearisation
import ev_control.asr.fuzzy
import ev_control.asr.held_torque
import ev_control.asr.least_squares
import ev_control.asr.least_squares_literal
import ev_control.asr.limp_home
import ev_control.asr.maximum_transmissible_torque
import ev_control.asr.modified_lambda
import ev_control.asr.off
import ev_control.asr.pi_slip
import ev_control.asr.slip_window
import ev_control.asr.speed_mode.speed_by_acceleration_ratio
import ev_control.asr.speed_mode.speed_by_slip
import ev_control.asr.speed_mode.speed_corridor  # noqa: F401
