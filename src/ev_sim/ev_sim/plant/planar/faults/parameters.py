"""What a flat tyre is like, and the faults of the car as tables."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_msgs_py.faults.fault import Fault, parsed
from ev_msgs_py.faults.kinds import OF_THE_CAR
from ev_msgs_py.parameters.declaration import ParameterError, parameter
from ev_msgs_py.parameters.shown import quoted
from ev_msgs_py.vehicle.description import Vehicle

CODES = tuple(OF_THE_CAR)
SHARE, STUCK, TRIP, DELAY, HALL, BATTERY, PUNCTURE = range(len(CODES))
LONGEST_DELAY = 50  # [control periods]


@dataclass(frozen=True, slots=True)
class PunctureParameters:
    """A tyre without air, beside the sound one; all of it is assumed."""

    radius: float = parameter(0.9, unit="1", low=0.5, high=1.0, about="rolling radius over that of the sound tyre")
    stiffness: float = parameter(
        0.3, unit="1", low=0.05, high=1.0, about="slip stiffness over that of the sound tyre, along and across"
    )
    rolling_resistance: float = parameter(
        0.2, unit="1", low=0.0, high=1.0, about="that a tyre without air adds to that of the sound one"
    )
    time: float = parameter(0.5, unit="s", low=0.0, high=1000.0, about="in which the air is lost, evenly")


class CarFaults(NamedTuple):
    """The faults of the car, one after the other: kind, first period with it and first without, value, and by wheel."""

    kind: tuple[float, ...]
    begin: tuple[float, ...]
    end: tuple[float, ...]
    value: tuple[float, ...]
    wheels: tuple[float, ...]  # four for each fault, 1 where it strikes


def car_faults(
    texts: tuple[str, ...], vehicle: Vehicle, period: float, is_brushless: bool, puncture_fits: bool
) -> CarFaults:
    """The tables; ParameterError for a fault that this car cannot have."""
    faults = [fault for fault in parsed(texts) if fault.kind in OF_THE_CAR]
    for fault in faults:
        _refuse(fault, vehicle, period, is_brushless, puncture_fits)
    periods = [fault.periods(period) for fault in faults]
    return CarFaults(
        tuple(float(CODES.index(fault.kind)) for fault in faults),
        tuple(begin for begin, _ in periods),
        tuple(end for _, end in periods),
        tuple(round(f.value / period) if f.kind == "inverter_delay" else f.value for f in faults),
        tuple(wheel for fault in faults for wheel in fault.wheels()),
    )


def _refuse(fault: Fault, vehicle: Vehicle, period: float, is_brushless: bool, puncture_fits: bool) -> None:
    driven = [n for n, hit in zip(WHEEL_NAMES, fault.wheels(), strict=True) if hit and n in vehicle.driven_wheels]
    of_motor = fault.kind not in ("battery_share", "puncture")
    coupling = vehicle.driveline.coupling
    for lacks, needed in (
        (of_motor and not driven, f"a motor there, of {', '.join(vehicle.driven_wheels)}"),
        (of_motor and vehicle.engine.peak_power > 0.0, "motors, not vehicle.engine"),
        (fault.kind == "hall_stuck" and not is_brushless, "drive ideal, averaged or switched"),
        (fault.kind == "hall_stuck" and coupling != "individual", "vehicle.driveline.coupling individual"),
        (fault.kind == "puncture" and not puncture_fits, "vehicle.tyre.lateral_curve same"),
        (
            fault.kind == "inverter_delay" and fault.value > LONGEST_DELAY * period,
            f"a delay of at most {LONGEST_DELAY * period:g} s, {LONGEST_DELAY} control periods",
        ),
    ):
        if lacks:
            raise ParameterError(f"faults: {quoted(fault.text)} needs {needed}")
