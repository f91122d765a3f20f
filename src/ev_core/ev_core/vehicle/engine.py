"""A combustion engine with torque converter and gearbox in the place of motors."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

from ev_core.parameters.declaration import group, parameter, setting
from ev_msgs_py.refusal import ParameterError

_CAR = "assumption for a medium car"


@dataclass(frozen=True, slots=True)
class Gearbox:
    """An automatic gearbox that shifts by the speed of its input; the final drive is the vehicle's `gear_ratio`."""

    ratios: tuple[float, ...] = parameter(
        (3.6, 2.2, 1.45, 1.0, 0.8), unit="1", low=0.1, high=20.0, about="of the forward gears, falling", source=_CAR
    )
    reverse: float = parameter(3.2, unit="1", low=0.1, high=20.0, about="ratio of the reverse gear", source=_CAR)
    efficiency: float = parameter(0.95, unit="1", low=0.5, high=1.0, about="in every gear, either way", source=_CAR)
    upshift_speed: float = parameter(
        350.0, unit="rad/s", low=1.0, high=5000.0, about="of the turbine, above which it shifts up", source=_CAR
    )
    downshift_speed: float = parameter(
        150.0, unit="rad/s", low=0.0, high=5000.0, about="of the turbine, below which it shifts down", source=_CAR
    )
    dwell: float = parameter(0.5, unit="s", low=0.0, high=100.0, about="that a gear stays in", source=_CAR)
    selector_speed: float = parameter(
        2.0,
        unit="rad/s",
        low=0.0,
        high=100.0,
        about="of the output, below which the sign of the wanted torque chooses between forwards and reverse",
        source="assumption: a driver who wants to go the other way moves the selector at rest",
    )

    def __post_init__(self) -> None:
        if not self.ratios or any(b >= a for a, b in pairwise(self.ratios)):
            raise ParameterError("ratios needs at least one element, and must fall")
        widest = max((a / b for a, b in pairwise(self.ratios)), default=1.0)
        if self.upshift_speed <= widest * self.downshift_speed:
            raise ParameterError(
                f"upshift_speed: {self.upshift_speed:g} is refused, allowed is more than {widest:.3g}, the widest step "
                "between gears, times downshift_speed: it would shift down again at once"
            )


@dataclass(frozen=True, slots=True)
class Engine:
    """Spark ignition engine, torque converter and gearbox; without peak power there are motors instead."""

    peak_power: float = setting(0.0, unit="W", low=0.0, high=1e7, about="at full load; 0 for no engine")
    peak_power_speed: float = parameter(580.0, unit="rad/s", low=1.0, high=5000.0, about="at which", source=_CAR)
    maximum_speed: float = parameter(
        650.0, unit="rad/s", low=1.0, high=5000.0, about="beyond which fuel is cut off", source=_CAR
    )
    idle_speed: float = parameter(85.0, unit="rad/s", low=1.0, high=1000.0, about="that the engine keeps", source=_CAR)
    idle_gain: float = parameter(
        3.0, unit="N m s/rad", low=0.0, high=1e3, about="torque of the idle control below it", source=_CAR
    )
    drag_torque: float = parameter(12.0, unit="N m", low=0.0, high=1e4, about="without fuel, at rest", source=_CAR)
    drag_growth: float = parameter(
        0.03, unit="N m s/rad", low=0.0, high=100.0, about="of that over the speed", source=_CAR
    )
    torque_lag: float = parameter(
        0.1, unit="s", low=1e-3, high=10.0, about="time constant of intake and combustion", source=_CAR
    )
    inertia: float = parameter(
        0.18, unit="kg m^2", low=1e-3, high=100.0, about="of crankshaft, flywheel and pump", source=_CAR
    )
    converter_size: float = parameter(
        1.0,
        unit="1",
        low=0.01,
        high=100.0,
        about="torque of the converter over that of the one measured in the source",
        source="Kotwicki, SAE 820393 (1982)",
    )
    gearbox: Gearbox = group(Gearbox)

    def __post_init__(self) -> None:
        if not self.idle_speed < self.peak_power_speed <= self.maximum_speed:
            raise ParameterError("idle_speed, peak_power_speed and maximum_speed must rise")
