"""A traction control as a method: what it does with one wheel is the law, the rest is the same for all of them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeVar

from ev_control.estimation.reference_speed import free_wheels_for
from ev_control.shared.limp_mode import limp_mode_for
from ev_control.shared.speed_mode import set_points
from ev_control.shared.traction_control import Measured, TractionControlState, limited, watch
from ev_core.law import Car, Need, WheelSpeedCommand, compilable, each_wheel, method, part
from ev_core.methods.law import named_after
from ev_msgs_py.compilable import FUNCTIONS
from ev_msgs_py.contract.signals import (
    InertialMeasurement,
    SteeringColumnState,
    WheelStates,
    WheelTorqueCommand,
    WheelTorqueRequest,
)

L = TypeVar("L", bound=Callable[..., float])


@compilable
def own_reference(p: Any) -> Any:
    """The reference speed's parameters of a law that has them itself."""
    return p.reference


@compilable
def reference_of_regulator(p: Any) -> Any:
    """Those of a law that regulates a slip."""
    return p.regulator.reference


@compilable
def own_limp_mode(p: Any) -> Any:
    """The limp mode's parameters of a law that has them itself."""
    return p.limp


@compilable
def limp_mode_of_regulator(p: Any) -> Any:
    """Those of a law that regulates a slip."""
    return p.regulator.limp


GROUPS = {
    "reference": (own_reference, own_limp_mode),
    "regulator.reference": (reference_of_regulator, limp_mode_of_regulator),
}


def traction_control(
    name: str,
    parameters: type,
    wheel: type,
    forget: Callable[..., None],
    reference: str = "reference",
    speed_mode: bool = False,
    needs: tuple[Need, ...] = (),
) -> Callable[[L], L]:
    """Register the law of one wheel as a method of the asr, under its docstring.

    The law is `(p, car, wheel, period, motion, wanted)` and gives the largest torque of the wheel [N m], as
    `traction_control.watch` says. `wheel` is the record of what it knows of a wheel, a LimitedWheel with more;
    `forget(p, wheel)` puts it to the start; `reference` names the parameters of the reference speed among its own, and
    `limp` beside them are those of the limp mode. The method runs compiled if both functions are compilable.

    With `speed_mode` the law gives the largest speed of the wheel [rad/s] for drives in speed mode, as
    `speed_mode.set_points` says, and has no limp mode. `needs` are what it asks of the vehicle besides.
    """
    reference_of, limp_of = GROUPS[reference]
    how: dict[str, Any] = {}
    if speed_mode:
        how = {"writes": (WheelTorqueCommand, WheelSpeedCommand), "requires": {"plant": "planar_speed_mode"}}

    def register(limit_of: L) -> L:
        @dataclass(slots=True)
        class State:
            """What lasts between steps."""

            control: TractionControlState = part(TractionControlState)
            wheels: list[Any] = each_wheel(wheel)

        def start(p: Any) -> State:
            state = State()
            for each in state.wheels:
                forget(p, each)
            return state

        def law(
            p: Any,
            car: Car,
            s: Any,
            period: float,
            request: WheelTorqueRequest,
            column: SteeringColumnState,
            wheels: WheelStates,
            imu: InertialMeasurement,
        ) -> WheelTorqueCommand:
            watch(limit_of, forget, reference_of(p), p, car, s, period, request, Measured(column, wheels, imu))
            return limited(limp_of(p), car, s, period, request, wheels)

        def law_of_speed(
            p: Any,
            car: Car,
            s: Any,
            period: float,
            request: WheelTorqueRequest,
            column: SteeringColumnState,
            wheels: WheelStates,
            imu: InertialMeasurement,
        ) -> tuple[WheelTorqueCommand, WheelSpeedCommand]:
            watch(limit_of, forget, reference_of(p), p, car, s, period, request, Measured(column, wheels, imu))
            return set_points(car, s, request)

        made: Callable[..., Any] = law_of_speed if speed_mode else law
        named_after(made, limit_of)
        if limit_of in FUNCTIONS and forget in FUNCTIONS:
            compilable(made)
        lacks: tuple[Need, ...] = (*needs, free_wheels_for(reference))
        if not speed_mode:
            lacks = (*lacks, limp_mode_for(f"{reference.rpartition('.')[0]}.limp".lstrip(".")))
        method("asr", name, parameters, state=State, start=start, needs=lacks, mirrored=True, **how)(made)
        return limit_of

    return register
