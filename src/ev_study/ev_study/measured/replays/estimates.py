"""Estimates on a record beside what was measured; `ev_core.methods.estimator` offers them.

How it works: an estimator makes one channel of others, with numbers of its parameters and of the
car, as laws have them. It runs over each stretch of the record from a start without knowledge, and
is held against what was measured, in the windows of the replay.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ev_core.methods.estimator import Estimator, estimators
from ev_core.methods.law import namespace
from ev_core.parameters.declaration import flatten, number_tree
from ev_core.parameters.values import build
from ev_core.vehicle.car import car_numbers
from ev_msgs_py.refusal import ParameterError
from ev_study.measured.records.record import LONGITUDINAL, ROAD_WHEEL_ANGLE, YAW_RATE
from ev_study.measured.replays.errors import Judged, judged
from ev_study.measured.replays.open_loop import COMPARED, OpenLoop


@dataclass(frozen=True)
class Estimate:
    """A `channel` as an estimator with these `parameters` has it, (windows, samples), and how far it is off."""

    name: str
    channel: str
    parameters: Mapping[str, Any]
    values: np.ndarray
    judged: Judged

    def as_json(self) -> dict[str, Any]:
        """Content for summary.json."""
        return {
            "estimates": self.channel,
            "parameters": dict(self.parameters),
            **self.judged.as_json(),
        }


def estimates_of(
    replay: OpenLoop, values: Mapping[str, Mapping[str, Any]]
) -> tuple[list[Estimate], list[str]]:
    """Estimate by each estimator with values by its name.

    A line for each without its channels. Each begins where the record does and restarts behind what
    is masked, and is judged in the windows of the replay. ParameterError for a value that is
    refused, or if none of them has its channels.
    """
    record, windows = replay.record, replay.windows
    # The angle of the road wheels even where that of the steering wheel was measured.
    given = {**record.channels, ROAD_WHEEL_ANGLE: replay.road_wheel_angle}
    car = namespace(car_numbers(replay.configurations["plant"].common.vehicle))
    acceleration = replay.measured(LONGITUDINAL) * replay.measured(YAW_RATE)
    found, lacking = [], []
    for name, each in estimators().items():
        parameters = _built(name, each, values.get(name, {}))
        if each.estimates not in COMPARED:
            raise ParameterError(
                f"{name} estimates {each.estimates}, expected one of {', '.join(COMPARED)}"
            )
        # A record with other sensors is no error of the command: a note names what it lacks.
        if missing := [
            channel for channel in (*each.reads, each.estimates) if channel not in given
        ]:
            lacking.append(f"{name} is not judged, the record has no {', '.join(missing)}")
            continue
        p, channels = (
            namespace(number_tree(parameters)),
            [n for n in (*each.reads, *each.may_read) if n in given],
        )
        estimated = np.full(len(record.valid), np.nan)
        # Begun anew behind each mask: the state of an estimator would span two drives.
        for stretch in record.stretches:
            estimated[stretch] = each.over(
                p, car, record.period, {n: given[n][stretch] for n in channels}
            )
        # In the same windows as the replay, so that both are compared on the same instants.
        inside, measured = windows.of(estimated), replay.measured(each.estimates)
        errors = judged(COMPARED[each.estimates], inside, measured, acceleration, record.period)
        found.append(Estimate(name, each.estimates, flatten(parameters), inside, errors))
    if not found:
        raise ParameterError(f"{record.source}: no estimator can be judged: {'; '.join(lacking)}")
    return found, lacking


def _built(name: str, estimator: Estimator, values: Mapping[str, Any]) -> Any:
    try:
        return build(estimator.parameters, values)
    except ParameterError as error:
        raise ParameterError(f"{name}: {error}") from None
