"""Report on a step input of the steering wheel, in the terms of ISO 7401.

Times count from the instant at which the steering-wheel angle passes half of its step; steady
values are the mean over the last second of the run.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ev_stack.figures.panels import motion_panels
from ev_stack.figures.sheets import Sheet
from ev_stack.measures import motion
from ev_stack.measures.metric import (
    LOWER,
    Metric,
    NotMeasured,
    Runs,
    channel,
    last,
    mean_between,
    metric,
)
from ev_stack.recording.recording import Recording

STEADY_WINDOW = 1.0  # [s]
STEADY_BAND = 0.03  # steady values change by less than this fraction from one window to the next


@dataclass(frozen=True, slots=True)
class Response:
    """One quantity after the step: `steady` and `peak`, with the sign of the step; times [s]."""

    steady: float
    peak: float
    response_time: float
    peak_time: float

    @property
    def overshoot(self) -> float:
        """Overshoot: distance of the peak beyond the steady value [%]."""
        return 100 * (self.peak / self.steady - 1)


def response(run: Recording, values: np.ndarray) -> Response:
    """The response of a quantity (n,); the response time ends at 90 % of the steady value.

    NotMeasured if the steering wheel is not turned, or if in the end the car stands or the quantity
    is not steady.
    """
    angle = channel(run, motion.STEERING_WHEEL_ANGLE)
    final = mean_between(run, angle, *last(run, STEADY_WINDOW))
    if final == 0.0:
        raise NotMeasured("the steering wheel is not turned")
    # Over the final value, which has a sign: a step to the right rises from 0 to 1, too.
    start = motion.crossing_time(run.time, angle / final, 0.5, "half of the step")
    end = float(run.time[-1])
    # The two windows that are compared below.
    if not motion.moving(run)[run.time >= end - 2 * STEADY_WINDOW].all():
        raise NotMeasured("the car stands in the end")
    steady = mean_between(run, values, end - STEADY_WINDOW, end)
    # Also of a car with a lateral quantity of exactly 0, by which the ratios divide.
    if not steady:
        raise NotMeasured("the car does not respond")
    if (
        abs(mean_between(run, values, end - 2 * STEADY_WINDOW, end - STEADY_WINDOW) / steady - 1)
        > STEADY_BAND
    ):
        raise NotMeasured("the response is not steady in the end")
    # Positive in the direction of the steady response, so one search serves left and right.
    relative = values / steady
    peak = int(relative.argmax())
    return Response(
        steady,
        float(values[peak]),
        motion.crossing_time(run.time, relative, 0.9, "90 % of the steady value") - start,
        float(run.time[peak]) - start,
    )


def metrics(runs: Runs) -> dict[str, Metric]:
    """Response times, overshoot, gains and the TB factor of each run."""
    return motion.of_each_run(runs, _metrics)


def figures(runs: Runs) -> dict[str, Sheet]:
    """Steering-wheel angle, yaw rate, lateral acceleration and sideslip angle of all runs."""
    names = ("steering_wheel_angle", "yaw_rate", "lateral_acceleration", "sideslip_angle")
    return {"step_steer": Sheet(motion_panels(runs, *names))}


def _metrics(run: Recording) -> dict[str, Metric]:
    def yaw() -> Response:
        return response(run, channel(run, motion.YAW_RATE))

    def lateral() -> Response:
        return response(run, motion.lateral_acceleration_on_path(run))

    def steering() -> float:
        return mean_between(
            run, channel(run, motion.STEERING_WHEEL_ANGLE), *last(run, STEADY_WINDOW)
        )

    def sideslip() -> float:
        return response(run, motion.sideslip_angle(run)).steady

    return {
        "steering_wheel_angle": metric(steering, "rad", "mean of the last second"),
        "lateral_acceleration": metric(
            lambda: lateral().steady, "m/s^2", "mean of the last second"
        ),
        "yaw_rate_response_time": metric(
            lambda: yaw().response_time,
            "s",
            "from half of the step to 90 % of the steady r (ISO 7401)",
            LOWER,
        ),
        "yaw_rate_peak_response_time": metric(
            lambda: yaw().peak_time, "s", "from half of the step to the peak of r", LOWER
        ),
        "yaw_rate_overshoot": metric(
            lambda: yaw().overshoot, "%", "100 (peak/steady r - 1)", LOWER
        ),
        "yaw_rate_gain": metric(
            lambda: yaw().steady / steering(), "1/s", "steady r over steering-wheel angle"
        ),
        "lateral_acceleration_response_time": metric(
            lambda: lateral().response_time,
            "s",
            "from half of the step to 90 % of the steady a_y",
            LOWER,
        ),
        "lateral_acceleration_gain": metric(
            lambda: lateral().steady / steering(),
            "m/(s^2 rad)",
            "steady a_y over steering-wheel angle",
        ),
        "sideslip_angle_gain": metric(
            lambda: sideslip() / steering(), "1", "steady beta over steering-wheel angle"
        ),
        "tb_factor": metric(
            lambda: yaw().peak_time * abs(np.degrees(sideslip())),
            "deg s",
            "peak response time of r times |steady beta|",
            LOWER,
        ),
    }
