"""A metric with a name, a unit and a formula; the driven run that it is computed from."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

from ev_core.lockstep.configuration import Configuration
from ev_core.vehicle.description import Vehicle
from ev_msgs_py.contract.roles import MASTER
from ev_msgs_py.refusal import ParameterError
from ev_sim.courses.course import CourseParameters
from ev_sim.surfaces import RoadParameters, Surface, left_and_right
from ev_stack.measures.metric import Metric, metric
from ev_stack.recording.offline import written_topics
from ev_stack.recording.recording import Recording


class DrivenRun(NamedTuple):
    """A driven run as metrics see it: true motion, car, surfaces of its road, and a closed course.

    `driver` are the parameters of its driver, such as his path.
    """

    signals: Recording
    vehicle: Vehicle
    surfaces: tuple[Surface, ...] = ()
    course: CourseParameters | None = None
    driver: Any = None


def driven_run(signals: Recording, configurations: Mapping[str, Configuration]) -> DrivenRun:
    """A run of these configurations; `signals` is its true motion."""
    plant, driver = configurations[MASTER], configurations.get("driver")
    # A method of a user's may have parameters without a road or a course.
    surfaces, given = surfaces_of(getattr(plant.given, "road", None)), driver and driver.given
    return DrivenRun(signals, plant.common.vehicle, surfaces, getattr(given, "course", None), given)


def surfaces_of(road: RoadParameters | None) -> tuple[Surface, ...]:
    """The surfaces that lie on a road; none of a plant that has none."""
    if road is None:
        return ()
    return tuple(
        map(
            road.surface,
            dict.fromkeys(name for side in left_and_right(road) for name in side.surface),
        )
    )


@dataclass(frozen=True, slots=True)
class NamedMetric:
    """A metric with a name: `formula` in one line, and `of`, which computes it in its unit.

    `of` raises NotMeasured where it cannot be computed.

    `needs` are the channels that it reads, or how the names of several begin.
    """

    name: str
    unit: str
    formula: str
    of: Callable[[DrivenRun], float]
    needs: tuple[str, ...]
    better: str = ""

    def measured(self, run: DrivenRun) -> Metric:
        """Its value for a run, or why it has none."""
        return metric(lambda: self.of(run), self.unit, formula=self.formula, better=self.better)

    def lacking(self, channels: Collection[str]) -> str:
        """The first of its needs that is not among some channels; empty if all are."""
        return next(
            (need for need in self.needs if not any(name.startswith(need) for name in channels)), ""
        )


def refuse_unmeasurable(
    metrics: Iterable[NamedMetric], configurations: Mapping[str, Configuration]
) -> None:
    """ParameterError for a metric of channels that no method of a graph writes."""
    channels = [name for topic in written_topics(configurations) for name in topic.channels]
    for each in metrics:
        # A need may be how several names begin: then a dot is at its end.
        if need := each.lacking(channels):
            methods = ", ".join(
                f"{role} {configured.method.name}" for role, configured in configurations.items()
            )
            raise ParameterError(
                f"metric {each.name} needs {need.rstrip('.')}, which none of these writes:"
                f" {methods}"
            )
