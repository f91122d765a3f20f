"""The scenarios of a test engineer."""

MANOEUVRES = (
    "coast_down",
    "double_lane_change",
    "hill_start",
    "launch_split_mu",
    "sine_with_dwell",
    "steady_circle",
    "step_steer",
    "straight_brake_split_mu",
)
