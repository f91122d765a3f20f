"""What had to be added to the dissertation so that a number comes out."""

from __future__ import annotations

ROAD = "wet asphalt 1, packed snow 1 (the middle of their f_surface), segments of 5 to 50 m"
IMPOSED = (
    "driver imposed_speed: the cycle imposes the speed, and in its windows of traction the driver asks for k = 1.11 "
    "times the power of packed snow's limit, k fitted on method 2"
)
NO_ROLLING = "M_f without rolling resistance, so of eq 2.37 only the ratio of speeds"
OF_METHOD = {
    1: "refused torque is dropped; ASR by least squares, made to work, with asr.use 0.95, below the fitted peak",
    2: "no ASR; k is fitted on this very number, so it is no evidence",
    3: "no ASR",
    4: "no ASR; K reaches 1.5 at a speed difference of 5 rad/s",
    5: "no ASR; friction and loads known, eq 1.2",
}
BENCH = (
    "torques, speeds, voltages and currents as our bench measures them: set-points late by 2 ms, shaft of 20 kN m/rad, "
    "exchange every 5 ms, errors of section 4.3 as two standard deviations of noise"
)
BATTERY = "206 cells in series, 3.2 V each, constant"


def wheel_efficiency(method: int, bench: bool = False) -> str:
    """Of a wheel efficiency with the driver imposed_speed."""
    return "; ".join([IMPOSED, NO_ROLLING, OF_METHOD[method], ROAD, *([BENCH] if bench else [])])
