"""Slip control by fuzzy rules (dissertation, section 1.3)."""

from __future__ import annotations

from dataclasses import dataclass, field

from ev_control.asr.slip_regulator import RegulatedWheel, SlipRegulator, SlipRegulatorParameters
from ev_control.asr.traction_control import WheelMotion
from ev_control.first_order_filter import Filtered, filter_share
from ev_msgs_py.methods import method
from ev_msgs_py.parameters import group, parameter
from ev_msgs_py.vehicle import Vehicle

# Change of the limit over its largest one; rows: slip below, at, above the target; columns: slip falls, stays, rises.
RULES = (
    (0.5, 0.3, 0.1),
    (0.2, 0.0, -0.4),
    (0.0, -0.4, -1.0),
)


@dataclass(frozen=True, slots=True)
class FuzzyParameters:
    """How wide the sets are and how fast the limit moves; the source gives no rule and no number."""

    error_width: float = parameter(
        0.08, unit="1", low=1e-3, high=1.0, about="slip over its target that is surely too much", source="assumption"
    )
    rate_width: float = parameter(
        2.0, unit="1/s", low=1e-3, high=100.0, about="rise of the slip that is surely one", source="assumption"
    )
    filter_time: float = parameter(
        0.02, unit="s", low=0.0, high=1.0, about="time constant of the rate of the slip", source="assumption"
    )
    largest_rate: float = parameter(
        10.0, unit="1/s", low=0.1, high=1000.0, about="largest change of the limit over itself", source="assumption"
    )
    least_torque: float = parameter(
        50.0,
        unit="N m",
        low=1.0,
        high=1e4,
        about="limit below which it changes as if it were this",
        source="assumption",
    )
    regulator: SlipRegulatorParameters = group(SlipRegulatorParameters)


@dataclass(slots=True)
class FuzzyWheel(RegulatedWheel):
    """Filtered slip [1], whose lag is its rate."""

    slip: Filtered = field(default_factory=Filtered)


@method("asr", "fuzzy")
class Fuzzy(SlipRegulator):
    """Move the limit by nine rules about the slip error and the rate of the slip.

    Error and rate, over their widths, each belong to three triangular sets (below, at, above; falls, stays, rises)
    whose degrees add up to one. A rule counts with the product of its two degrees; the limit changes by the sum of the
    rules' (`RULES`) times `largest_rate` times itself, which is the weighted mean as in Takagi and Sugeno. The rules
    take torque away faster than they give it back. The dissertation (section 1.3) reports fuzzy slip control without a
    rule, so these are an assumption.
    """

    parameters = FuzzyParameters

    def __init__(self, parameters: FuzzyParameters, vehicle: Vehicle, period: float) -> None:
        p = self._p = parameters
        self._share = filter_share(period, p.filter_time)
        self._lag = max(p.filter_time, period)
        super().__init__("fuzzy", FuzzyWheel, p.regulator, vehicle, period)

    def _regulated(self, wheel: FuzzyWheel, motion: WheelMotion, slip: float, wanted: float, begins: bool) -> float:
        p = self._p
        last = wheel.slip.value if wheel.slip.value is not None and not begins else slip
        rate = (slip - last) / (self._lag + self._period)
        wheel.slip.value = last + self._share * (slip - last)
        errors = degrees((slip - self._regulator.target) / p.error_width)
        rates = degrees(rate / p.rate_width)
        change = sum(
            e * r * rule for e, row in zip(errors, RULES, strict=True) for r, rule in zip(rates, row, strict=True)
        )
        limit = min(max(motion.torque, 0.0), wanted) if begins else min(wheel.limit, wanted)
        return limit + p.largest_rate * self._period * change * max(limit, p.least_torque)


def degrees(value: float) -> tuple[float, float, float]:
    """How far a number belongs to the sets about -1, 0 and 1 [1]; the degrees add up to one."""
    value = min(max(value, -1.0), 1.0)
    return max(-value, 0.0), 1 - abs(value), max(value, 0.0)
