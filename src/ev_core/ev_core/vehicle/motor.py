"""Drives of a vehicle: motors with inverter and gear, or an engine in their place.

The engine has a torque converter and a gearbox.
"""

from dataclasses import dataclass
from functools import partial
from itertools import pairwise

from ev_core.parameters.declaration import group, own, parameter, setting
from ev_msgs_py.compilable import inlined
from ev_msgs_py.refusal import ParameterError

_of_winding = partial(
    parameter,
    source="assumption for a YASA-400; its curves (figure 1.22 of the dissertation) are lost",
)
# share of the maximum speed over which the drive torque fades; it softens a corner
SPEED_FADE = 0.02
LEAST_SPEED = 1e-9  # [rad/s], of a power divided by it


@dataclass(frozen=True, slots=True)
class Winding:
    """A synchronous machine with magnets on the surface of its rotor: one inductance in both axes.

    Its resistance is not declared twice: the motor's `copper_loss` and the torque constant 3/2 p
    psi give it.
    """

    pole_pairs: int = _of_winding(10, unit="1", low=1, high=100, about="pole pairs, p")
    flux_linkage: float = _of_winding(
        0.0377,
        unit="Wb",
        low=1e-4,
        high=10.0,
        about="peak flux linkage of the magnets with a phase, psi: 0.8 N m for each rms ampere",
    )
    inductance: float = _of_winding(
        1e-4, unit="H", low=1e-6, high=1.0, about="of a phase, alike in both axes, L"
    )
    largest_current: float = _of_winding(
        453.0, unit="A", low=1.0, high=1e4, about="largest rms phase current"
    )
    voltage_share: float = parameter(
        0.95,
        unit="1",
        low=0.1,
        high=1.0,
        about="of the largest phase voltage, V_dc/sqrt(3), that field weakening makes use of; the "
        "rest is left to the "
        "resistance of the winding and to the current control",
    )


@dataclass(frozen=True, slots=True)
class ThermalParameters:
    """One heat capacity each for winding and inverter, cooled by one coolant."""

    coolant: float = parameter(40.0, unit="degC", low=-40.0, high=120.0, about="coolant inlet")
    coolant_flow: float = parameter(8.0, unit="l/min", low=0.1, high=31.0, about="of the coolant")
    winding_capacity: float = parameter(
        4000.0, unit="J/K", low=1.0, high=1e6, about="heat capacity of the winding"
    )
    winding_resistance: float = parameter(
        0.015, unit="K/W", low=1e-4, high=10.0, about="from winding to coolant"
    )
    inverter_capacity: float = parameter(
        1500.0, unit="J/K", low=1.0, high=1e6, about="heat capacity of the power stage"
    )
    inverter_resistance: float = parameter(
        0.02, unit="K/W", low=1e-4, high=10.0, about="from power stage to coolant"
    )
    winding_warm: float = parameter(
        120.0, unit="degC", low=-40.0, high=215.0, about="from here on the torque is derated"
    )
    winding_limit: float = parameter(
        140.0, unit="degC", low=-40.0, high=215.0, about="fault; no torque is left here"
    )
    inverter_warm: float = parameter(
        75.0, unit="degC", low=-40.0, high=215.0, about="from here on the torque is derated"
    )
    inverter_limit: float = parameter(
        90.0, unit="degC", low=-40.0, high=215.0, about="fault; no torque is left here"
    )

    def __post_init__(self) -> None:
        if self.winding_warm >= self.winding_limit or self.inverter_warm >= self.inverter_limit:
            raise ParameterError("winding_warm and inverter_warm must be below their limits")


@dataclass(frozen=True, slots=True)
class Motor:
    """A torque-controlled motor with its inverter and gear; one for each driven wheel.

    The defaults are assumptions for a small city car's front drive with two motors.
    """

    peak_torque: float = own(
        250.0, unit="N m", low=0.0, high=1e5, about="at the shaft, for a short time"
    )
    nominal_torque: float = own(
        150.0, unit="N m", low=1e-3, high=1e5, about="at the shaft, for ever"
    )
    peak_power: float = own(
        40e3, unit="W", low=1.0, high=1e7, about="mechanical power for a short time"
    )
    overload_time: float = setting(
        60.0, unit="s", low=0.1, high=1e5, about="thermal time constant that ends the short time"
    )
    maximum_speed: float = own(
        1000.0, unit="rad/s", low=1.0, high=1e5, about="of the shaft; no drive torque beyond"
    )
    generator_torque: float = own(
        150.0,
        unit="N m",
        low=0.0,
        high=1e5,
        about="largest torque when the motor feeds the battery",
    )
    generator_power: float = own(
        25e3, unit="W", low=0.0, high=1e7, about="largest mechanical power that the motor takes"
    )
    torque_lag: float = setting(
        0.005, unit="s", low=1e-4, high=10.0, about="time constant of the torque control"
    )
    rotor_inertia: float = setting(
        0.0, unit="kg m^2", low=0.0, high=100.0, about="of one rotor, at the shaft"
    )
    gear_efficiency: float = setting(
        1.0, unit="1", low=0.5, high=1.0, about="of the gear, either way"
    )
    copper_loss: float = setting(
        0.05,
        unit="W/(N m)^2",
        low=0.0,
        high=1e3,
        about="loss per squared torque: winding resistance",
    )
    iron_loss: float = setting(
        0.5, unit="W s/rad", low=0.0, high=1e3, about="loss per speed: hysteresis and bearings"
    )
    eddy_loss: float = setting(
        5e-4,
        unit="W s^2/rad^2",
        low=0.0,
        high=10.0,
        about="loss per squared speed: eddy currents and windage",
    )
    inverter_loss: float = setting(
        20.0, unit="W", low=0.0, high=1e4, about="inverter's loss without torque"
    )
    inverter_torque_loss: float = setting(
        1.0,
        unit="W/(N m)",
        low=0.0,
        high=100.0,
        about="inverter's loss per torque: switching and conduction",
    )
    map_speed: tuple[float, ...] = setting(
        (),
        unit="rad/s",
        low=0.0,
        high=1e5,
        about="shaft speeds of an efficiency map; empty for the loss model",
    )
    map_torque: tuple[float, ...] = setting(
        (), unit="N m", low=0.0, high=1e5, about="shaft torques of the efficiency map"
    )
    map_efficiency: tuple[float, ...] = setting(
        (),
        unit="1",
        low=0.01,
        high=1.0,
        about="efficiency of motor and inverter, speed by speed (row by row)",
    )
    map_file: str = setting(
        "",
        about="CSV file with the columns speed_radps or speed_rpm, torque_nm and efficiency, "
        "instead of the map; empty "
        "for none",
    )
    winding: Winding = group(Winding)
    thermal: ThermalParameters = group(ThermalParameters)

    def __post_init__(self) -> None:
        if len(self.map_efficiency) != len(self.map_speed) * len(self.map_torque):
            raise ParameterError(
                "map_efficiency needs one element for each pair of map_speed and map_torque"
            )
        for name in ("map_speed", "map_torque"):
            axis = getattr(self, name)
            if len(axis) == 1 or any(b <= a for a, b in pairwise(axis)):
                raise ParameterError(f"{name} needs at least two elements and must rise")


@inlined
def speed_fade(maximum: float, turns: float) -> float:
    """Share [1] of the torque that is left near the maximum speed, at a speed [rad/s]."""
    return min(max((maximum - turns) / (SPEED_FADE * maximum), 0.0), 1.0)


@inlined
def driving_torque(motor: Motor, most: float, share: float, turns: float) -> float:
    """Largest torque [N m] at a speed [rad/s].

    `most` [N m] and a share of the peak power [1] bound it.
    """
    return min(most, share * motor.peak_power / max(turns, LEAST_SPEED)) * speed_fade(
        motor.maximum_speed, turns
    )


@inlined
def generating_torque(motor: Motor, most: float, share: float, turns: float) -> float:
    """The same of a motor that is driven, with its generator's torque and power.

    No speed is too much for it.
    """
    return min(
        most, motor.generator_torque, share * motor.generator_power / max(turns, LEAST_SPEED)
    )


_of_engine = partial(parameter, source="assumption for a medium car")


@dataclass(frozen=True, slots=True)
class Gearbox:
    """An automatic gearbox that shifts by the speed of its input.

    The final drive is the vehicle's `gear_ratio`.
    """

    ratios: tuple[float, ...] = _of_engine(
        (3.6, 2.2, 1.45, 1.0, 0.8),
        unit="1",
        low=0.1,
        high=20.0,
        about="of the forward gears, falling",
    )
    reverse: float = _of_engine(
        3.2, unit="1", low=0.1, high=20.0, about="ratio of the reverse gear"
    )
    efficiency: float = _of_engine(
        0.95, unit="1", low=0.5, high=1.0, about="in every gear, either way"
    )
    upshift_speed: float = _of_engine(
        350.0, unit="rad/s", low=1.0, high=5000.0, about="of the turbine, above which it shifts up"
    )
    downshift_speed: float = _of_engine(
        150.0,
        unit="rad/s",
        low=0.0,
        high=5000.0,
        about="of the turbine, below which it shifts down",
    )
    dwell: float = _of_engine(0.5, unit="s", low=0.0, high=100.0, about="that a gear stays in")
    selector_speed: float = parameter(
        2.0,
        unit="rad/s",
        low=0.0,
        high=100.0,
        about="of the output, below which the sign of the wanted torque chooses between forwards "
        "and reverse",
        source="assumption: a driver that wants to go the other way moves the selector at rest",
    )

    def __post_init__(self) -> None:
        if not self.ratios or any(b >= a for a, b in pairwise(self.ratios)):
            raise ParameterError("ratios needs at least one element, and must fall")
        widest = max((a / b for a, b in pairwise(self.ratios)), default=1.0)
        if self.upshift_speed <= widest * self.downshift_speed:
            raise ParameterError(
                f"upshift_speed: {self.upshift_speed:g} is refused, expected more than "
                f"{widest:.3g}, the widest step "
                "between gears, times downshift_speed: it would shift down again at once"
            )


@dataclass(frozen=True, slots=True)
class Engine:
    """Spark ignition engine, torque converter and gearbox.

    Without peak power there are motors instead.
    """

    peak_power: float = setting(
        0.0, unit="W", low=0.0, high=1e7, about="at full load; 0 for no engine"
    )
    peak_power_speed: float = _of_engine(
        580.0, unit="rad/s", low=1.0, high=5000.0, about="at which"
    )
    maximum_speed: float = _of_engine(
        650.0, unit="rad/s", low=1.0, high=5000.0, about="beyond which fuel is cut off"
    )
    idle_speed: float = _of_engine(
        85.0, unit="rad/s", low=1.0, high=1000.0, about="that the engine keeps"
    )
    idle_gain: float = _of_engine(
        3.0, unit="N m s/rad", low=0.0, high=1e3, about="torque of the idle control below it"
    )
    drag_torque: float = _of_engine(
        12.0, unit="N m", low=0.0, high=1e4, about="without fuel, at rest"
    )
    drag_growth: float = _of_engine(
        0.03, unit="N m s/rad", low=0.0, high=100.0, about="of that over the speed"
    )
    torque_lag: float = _of_engine(
        0.1, unit="s", low=1e-3, high=10.0, about="time constant of intake and combustion"
    )
    inertia: float = _of_engine(
        0.18, unit="kg m^2", low=1e-3, high=100.0, about="of crankshaft, flywheel and pump"
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
