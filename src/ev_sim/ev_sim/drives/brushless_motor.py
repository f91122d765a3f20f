"""The brushless DC motor of Shchur (2019), and its averaged drive, which has no commutation.

It is a star with trapezoidal EMF. The averaged drive has two phases in series on a continuously
adjustable voltage:

    2 L i' = u - 2 R i - 2 p psi omega,    M = 2 p psi i

It is what the switched drive does between two commutations, averaged over the chopping of the
converter (Pillay and Krishnan, Modeling, simulation, and analysis of permanent-magnet motor drives,
part II, IEEE Trans. Ind. Appl. 25, 1989). The converter is lossless, takes what the motor
regenerates, and sets the voltage without delay.

It holds while the bus leaves room for the current control. Beyond, where the EMF exceeds the bus
voltage, the sign of the torque is still right, but only the switched drive knows that the phase
reactance p omega L limits the current.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import auto
from math import tau
from typing import Any, NamedTuple

from ev_core.law import Choice, ParameterError, compilable, entry, group, parameter, setting

SECTOR = math.pi / 3.0  # width of a Hall sector, as an electrical angle [rad]


@dataclass(slots=True)
class DriveState:
    """One drive; it starts without current in the middle of a Hall sector."""

    torque: float = entry(unit="N m", about="electromagnetic, at the shaft, now")
    current: float = entry(unit="A", about="in at one phase and out at another, now")
    mean_torque: float = entry(unit="N m", about="over the last advance")
    electrical_power: float = entry(unit="W", about="from the bus, mean over the last advance")
    voltage_integral: float = entry(unit="V", about="of the PI current control")
    high_current: float = entry(unit="A", about="switched: into the phase on its positive EMF flat")
    off_current: float = entry(unit="A", about="switched: into the phase that is switched off")
    voltage_sign: float = entry(
        1.0, unit="1", about="switched: 1 with the high phase on the upper rail, -1 on the lower"
    )
    sector_angle: float = entry(
        SECTOR / 2.0, unit="rad", about="switched: electrical, from the lower edge of the sector"
    )
    sector: float = entry(unit="1", about="switched: Hall sector, 0 to 5")


@compilable
def crossing_shape(sector: float, sector_angle: float) -> float:
    """EMF of the off phase over that of the flats.

    It goes from 1 down to -1 in even sectors, up in odd ones.
    """
    falling = 1.0 - 2.0 * sector_angle / SECTOR
    return falling if int(sector) % 2 == 0 else -falling


@compilable
def time_to_edge(sector_angle: float, electrical_speed: float) -> float:
    """Time until the rotor enters the next sector [s]; infinite at rest."""
    if electrical_speed > 0.0:
        return (SECTOR - sector_angle) / electrical_speed
    if electrical_speed < 0.0:
        return sector_angle / -electrical_speed
    return math.inf


@compilable
def turned(sector_angle: float, electrical_speed: float, step: float, at_edge: bool) -> float:
    """Angle within the sector after a step [rad].

    It is exactly on the edge where the step was cut to end there.
    """
    if at_edge:
        return SECTOR if electrical_speed > 0.0 else 0.0
    return min(max(sector_angle + electrical_speed * step, 0.0), SECTOR)


@compilable
def enter_sector(s: DriveState, electrical_speed: float) -> None:
    """Commutate if the rotor is on the edge that it moves across.

    One phase takes over from the off phase. Between an even sector and the next one high stays,
    between an odd one and the next low stays.
    """
    if electrical_speed > 0.0 and s.sector_angle >= SECTOR:
        lower_sector = int(s.sector)
        s.sector = float((lower_sector + 1) % 6)
        s.sector_angle = 0.0
    elif electrical_speed < 0.0 and s.sector_angle <= 0.0:
        lower_sector = (int(s.sector) + 5) % 6
        s.sector = float(lower_sector)
        s.sector_angle = SECTOR
    else:
        return
    # Even: high stays, so off and low change places, and the low phase carries -(high + off). Odd:
    # low stays, so high and off change places. Both ways alike.
    if lower_sector % 2 == 0:
        s.off_current = -(s.high_current + s.off_current)
    else:
        s.high_current, s.off_current = s.off_current, s.high_current


@compilable
def torque_share(electrical_angle: float) -> float:
    """Torque over that of right commutation with the same current [1], at a rotor angle [rad].

    Of the six codes 101 100 110 010 011 001 the stuck sensor, the first one, falsifies three: 010
    reads 110, a sector late, 011 reads 111, which no rotor shows and at which the bridge blocks,
    and 001 reads 101, a sector early. The pair of phases of the sector before loses its EMF over
    the sector in the line, that of the sector behind gains it. The mean is 2/3, and in one sector
    the motor cannot pull away.
    """
    turn = electrical_angle / tau
    place = 6.0 * (turn - float(int(turn)))
    if place < 0.0:
        place += 6.0
    if place < 3.0:
        return 1.0
    if place < 4.0:
        return 4.0 - place
    return 0.0 if place < 5.0 else place - 5.0


class Winding(Choice):
    """Readings of the winding that resistance, inductance and flux linkage belong to."""

    ARMATURE = auto()
    PHASE = auto()


@dataclass(frozen=True, slots=True)
class MotorParameters:
    """Motor with permanent magnets; the source has no iron losses, friction or saturation."""

    pole_pairs: int = parameter(
        10, unit="1", low=1, high=100, about="pole pairs, p", source="Shchur 2019"
    )
    winding: Winding = parameter(
        Winding.ARMATURE,
        about="winding that has R, L and psi: armature, two phases in series as they conduct, or "
        "phase, one of them",
        source="Shchur 2019 gives those of the armature winding",
    )
    resistance: float = parameter(
        0.15,
        unit="ohm",
        low=0.0,
        high=100.0,
        about="resistance of the winding, R",
        source="Shchur 2019",
    )
    inductance: float = parameter(
        0.008,
        unit="H",
        low=1e-6,
        high=1.0,
        about="inductance of the winding, L; of a phase less its mutual inductance to another "
        "(taken for the source's 8 mH)",
        source="Shchur 2019",
    )
    flux_linkage: float = parameter(
        0.2,
        unit="Wb",
        low=1e-4,
        high=10.0,
        about="flux linkage of a pole pair with the winding, psi: on the flats its EMF is "
        "p psi omega",
        source="Shchur 2019",
    )
    torque_limit: float = setting(
        500.0,
        unit="N m",
        low=0.0,
        high=1e5,
        about="limit of the torque reference, far above what the paper needs",
    )


class Phase(NamedTuple):
    """One phase of the motor."""

    resistance: float  # R [ohm]
    inductance: float  # L [H]
    flux_linkage: float  # psi [Wb]


@compilable
def phase_of(motor: MotorParameters) -> Phase:
    """One phase; two of them in series are the armature winding."""
    share = 0.5 if motor.winding == Winding.ARMATURE else 1.0
    return Phase(share * motor.resistance, share * motor.inductance, share * motor.flux_linkage)


@compilable
def torque_constant(motor: MotorParameters) -> float:
    """Constant 2 p psi of two conducting phases [N m/A, V s].

    It is their torque over their current, and their EMF over the shaft speed.
    """
    return 2.0 * motor.pole_pairs * phase_of(motor).flux_linkage


@dataclass(frozen=True, slots=True)
class CurrentControllerParameters:
    """Current controller; Shchur (2019) gives none, so structure and parameters are assumptions."""

    bandwidth: float = setting(
        3000.0,
        unit="rad/s",
        low=1.0,
        high=1e5,
        about="of the current loop; a zero cancels the motor's pole -R/L",
    )
    emf_feedforward: float = setting(
        1.0,
        unit="1",
        low=0.0,
        high=1.0,
        about="share of the EMF that the controller adds from the measured speed",
    )


class Held(NamedTuple):
    """Shaft speed and voltage of the bus, which a drive sees as constant over a step."""

    speed: float  # [rad/s]
    bus_voltage: float  # [V], above zero


@compilable
def controlled_voltage(
    s: DriveState,
    controller: CurrentControllerParameters,
    motor: MotorParameters,
    error: float,
    held: Held,
    sampling_period: float,
) -> float:
    """Voltage across the two phases for the next sampling period [V], within that of the bus.

    Advances `s.voltage_integral`. Where the bus limits the voltage, the integral takes only as much
    of the error as the motor has seen (back-calculation). Currents in A, shaft speed in rad/s.
    """
    # Two phases in series have 2 L and 2 R; the ratio of the gains, R/L, is the zero on the motor's
    # pole.
    phase = phase_of(motor)
    proportional_gain = controller.bandwidth * 2.0 * phase.inductance
    integral_gain = controller.bandwidth * 2.0 * phase.resistance
    emf = torque_constant(motor) * held.speed
    wanted = proportional_gain * error + s.voltage_integral + controller.emf_feedforward * emf
    voltage = min(max(wanted, -held.bus_voltage), held.bus_voltage)
    # The error that would just have asked for the limited voltage.
    seen = error + (voltage - wanted) / proportional_gain
    s.voltage_integral += sampling_period * integral_gain * seen
    return voltage


@dataclass(frozen=True, slots=True)
class AveragedDriveParameters:
    """Averaged drive; all of it is assumed."""

    sampling_period: float = setting(
        1e-4,
        unit="s",
        low=1e-6,
        high=1e-3,
        about="longest time between two samples of the current controller",
    )
    current_controller: CurrentControllerParameters = group(CurrentControllerParameters)

    def __post_init__(self) -> None:
        if self.sampling_period * self.current_controller.bandwidth > 1.0:
            raise ParameterError(
                f"current_controller.bandwidth: {self.current_controller.bandwidth!r} is refused, "
                f"expected at most "
                f"1 / sampling_period = {1 / self.sampling_period:g} rad/s, beyond which the "
                f"sampled loop overshoots"
            )


@compilable
def advance_averaged(
    s: DriveState, p: Any, torque_reference: float, held: Held, duration: float
) -> None:
    """Advance the current under its control, and set the outputs of the state.

    Implicit midpoint rule: electrical energy = copper loss + mechanical work + change of magnetic
    energy up to rounding.
    """
    motor = p.motor
    phase = phase_of(motor)
    constant = torque_constant(motor)
    current_reference = torque_reference / constant
    emf = constant * held.speed
    # Whole samples in a step; rounding does not make one more.
    samples = max(1, math.ceil(duration / p.averaged.sampling_period - 1e-9))
    period = duration / samples
    # Midpoint rule: the current in R i is the mean of both ends of the step.
    half_decay = period * phase.resistance / (2.0 * phase.inductance)
    current = s.current
    charge = 0.0
    energy = 0.0
    for _ in range(samples):
        voltage = controlled_voltage(
            s, p.averaged.current_controller, motor, current_reference - current, held, period
        )
        drive = period * (voltage - emf) / (2.0 * phase.inductance)
        next_current = (current * (1.0 - half_decay) + drive) / (1.0 + half_decay)
        passed = period * (current + next_current) / 2.0
        charge += passed
        energy += voltage * passed
        current = next_current
    s.current = current
    s.torque = constant * current
    s.mean_torque = constant * charge / duration
    s.electrical_power = energy / duration
