"""Step responses, by which fig 1 of Shchur (2019) is judged."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ev_stack.measures.metric import NotMeasured


@dataclass(frozen=True, slots=True)
class StepResponse:
    """Numbers by which a step response is judged.

    steady_value: mean over the last second, in the unit of the response.
    overshoot: extreme in the direction of the step beyond the steady value, as a percentage of the
        change from the value at the step to the steady value; zero if there is none.
    settling_time: from the step to the last crossing into the band around the steady value [s],
        linear between two samples; zero if the response never leaves the band.
    """

    steady_value: float
    overshoot: float
    settling_time: float


def step_response(
    time: np.ndarray,
    response: np.ndarray,
    step_time: float,
    band: float = 0.05,
    window: float = 1.0,
) -> StepResponse:
    """Judge the response to a step at `step_time`, sampled as (n,) over time (n,) [s].

    `band` is the half width of the settling band as a fraction of the change. NotMeasured if fewer
    than two windows were recorded after the step, if the response does not change, or if it has not
    settled into the band by the beginning of the last window.
    """
    after = time >= step_time
    time, response = time[after], response[after]
    if len(time) < 2 or time[-1] - time[0] < 2 * window:
        raise NotMeasured(f"less than {2 * window:g} s were recorded after the step")
    steady_value = float(response[time >= time[-1] - window].mean())
    change = steady_value - response[0]
    if change == 0.0:
        raise NotMeasured("there is no change after the step")
    deviation = (response - steady_value) / change
    settling_time = _settling_time(time, deviation, band)
    # Otherwise the mean of the last window is no steady value.
    if settling_time > time[-1] - window - step_time:
        raise NotMeasured(
            f"the response has not settled to {100 * band:g} % "
            f"before the last {window:g} s of the run"
        )
    overshoot = 100 * max(0.0, float(deviation.max()))
    return StepResponse(steady_value, overshoot, settling_time)


def first_peaks(time: np.ndarray, response: np.ndarray) -> list[tuple[float, float]]:
    """Time [s] and value of the local maxima of a response (n,), in their order.

    NotMeasured if there are fewer than two.
    """
    inner = response[1:-1]
    rises = inner > response[:-2]
    falls = inner >= response[2:]
    peaks = np.flatnonzero(rises & falls) + 1
    if len(peaks) < 2:
        raise NotMeasured("the response has less than two peaks")
    return [(float(time[at]), float(response[at])) for at in peaks]


def _settling_time(time: np.ndarray, deviation: np.ndarray, band: float) -> float:
    outside = np.flatnonzero(np.abs(deviation) > band)
    if not len(outside):
        return 0.0
    last = outside[-1]
    if last == len(time) - 1:
        return math.inf
    # Where the line from the last sample outside to the first one inside crosses the band.
    edge = np.copysign(band, deviation[last])
    fraction = (deviation[last] - edge) / (deviation[last] - deviation[last + 1])
    return float(time[last] + fraction * (time[last + 1] - time[last]) - time[0])
