"""The planar plant linearised by finite differences about steady cornering, straight running or an acceleration.

And the Bode plot of its slip angles beside those of the linear model.

How it works: the compiled plant is driven until its motion is that of the operating point. There
its equations are evaluated at small steps of each state and of the steering angle; the central
differences are A, B, C and D. States that only move the car along (place, heading, speed) are left
out.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.signal import StateSpace, bode

from ev_core.compiled.part import CompiledPart
from ev_core.lockstep.finding import find_method
from ev_core.vehicle.description import Vehicle
from ev_msgs_py.contract.fields import shape_of
from ev_msgs_py.contract.frame import PLACES, Frame, numbers_of
from ev_msgs_py.contract.signals import SteeringColumnState, WheelTorqueCommand
from ev_msgs_py.contract.wheels import NO_WHEELS, Wheels
from ev_sim.plant.planar.body import Equations
from ev_sim.plant.planar.planar import PlanarPlantParameters
from ev_sim.plant.planar.planar_state import (
    INTEGRATED_PLACES,
    INTEGRATED_SIZE,
    VX,
    VY,
    YAW_RATE,
    index,
)
from ev_sim.surfaces import REFERENCE, RoadParameters
from ev_stack.figures.panels import Axes, Curve, Panel
from ev_stack.figures.sheets import Sheet
from ev_study.analysis.linear_models import SideSlipModel

OUTPUTS = ("lateral_velocity", "yaw_rate", "front_slip_angle", "rear_slip_angle")
# What moves the car across and round; the longitudinal velocity is a parameter of the linear model.
_STATES = (
    "lateral_velocity",
    "yaw_rate",
    "longitudinal_transfer",
    "lateral_transfer",
    "wheel_speed",
    "longitudinal_deflection",
    "lateral_deflection",
    "longitudinal_slip",
    "lateral_slip",
)
_STATES_OF_ROLL = ("roll_angle", "roll_rate")
_DRIVE = slice(index("mean_drive"), index("mean_drive") + 4)
_PERIOD = 0.01  # [s]
_SETTLING = 10.0  # [s], long against every motion of a car but its acceleration
# largest rate of yaw rate [rad/s^2] and lateral velocity [m/s^2] that counts as none
_STEADY = 1e-6
# of the central differences, in the unit of each state: far below any of them, far above rounding
_STEP = 1e-6
_FREQUENCIES = np.logspace(-1.0, 1.5, 200)  # [Hz]; a driver steers with up to about 3 Hz


@dataclass(frozen=True, slots=True)
class OperatingPoint:
    """About which motion to linearise.

    `drive` [N m] acts at the wheels. The speed [m/s] is held, or, with `accelerates`, passed
    straight ahead.
    """

    speed: float
    road_wheel_angle: float = 0.0  # [rad]
    drive: Wheels = NO_WHEELS
    accelerates: bool = False
    surface: str = REFERENCE


@dataclass(frozen=True, slots=True, eq=False)
class LinearisedPlant:
    """x' = A x + B delta, y = C x + D delta about a motion, input road-wheel angle [rad], outputs OUTPUTS.

    `states` names the states of the model in order, `state` is that of the plant at the point,
    `acceleration` the rate of its longitudinal velocity [m/s^2].
    """

    system: StateSpace
    states: tuple[str, ...]
    state: np.ndarray
    acceleration: float

    def response(self, frequency: np.ndarray) -> np.ndarray:
        """Complex response of OUTPUTS to the road-wheel angle at circular frequencies (n,) [rad/s], shape (n, 4).

        Solved from the matrices: scipy goes over the coefficients of a polynomial of degree 24 and
        loses all digits.
        """
        s = self.system
        eye = np.eye(s.A.shape[0])
        return np.array(
            [
                (s.C @ np.linalg.solve(1j * w * eye - s.A, s.B) + s.D)[:, 0]
                for w in np.atleast_1d(frequency)
            ]
        )

    def slip_angle_difference(self, frequency: np.ndarray) -> np.ndarray:
        """Response of dA = d2 - d1 to the road-wheel angle, (n,).

        Zhileykin's W12 with all that it leaves out.
        """
        found = self.response(frequency)
        return (
            found[:, OUTPUTS.index("rear_slip_angle")] - found[:, OUTPUTS.index("front_slip_angle")]
        )


def linearised(vehicle: Vehicle, point: OperatingPoint) -> LinearisedPlant:
    """The linear model of the planar plant at an operating point.

    Held speed: the plant runs at it until it is steady; ValueError if it never is. An acceleration
    starts below the speed and is frozen as it passes it, seen from slip angles: since d = (v + a
    r)/V, their rates have
    -V'/V d besides those of v and r.
    """
    state = _brought_to(vehicle, point)
    middle, drive = state[:INTEGRATED_SIZE], state[_DRIVE]
    equations = Equations(_parameters(point, point.speed), vehicle)
    equations.look(middle)
    # A rigid body has a roll that stays 0, which is no motion.
    moving = (*_STATES, *_STATES_OF_ROLL) if vehicle.suspension.rolls else _STATES
    places = [
        n for n, place in enumerate(INTEGRATED_PLACES) if place.name.partition(".")[0] in moving
    ]

    # The drive torques are those at the point, whatever the angle is.
    def rates_at(change: np.ndarray, angle: float) -> np.ndarray:
        equations.hold(angle, drive)
        return equations.rates(_moved(middle, places, change), starts=True)[places]

    def outputs_at(change: np.ndarray, angle: float) -> np.ndarray:
        return _outputs(vehicle, _moved(middle, places, change), angle)

    still, size, angle = np.zeros(len(places)), len(places), point.road_wheel_angle
    # Rates of the states that are left over at the point.
    rest = rates_at(still, angle)
    # The longitudinal velocity is no state of the linear model, so its rate is read apart.
    acceleration = float(equations.rates(middle, starts=True)[VX])
    if not point.accelerates and np.abs(rest[:2]).max() > _STEADY:
        raise ValueError(
            f"no steady motion at {point.speed:g} m/s and {angle:g} rad: the car goes on turning in"
        )
    a, c = np.empty((size, size)), np.empty((len(OUTPUTS), size))
    for n in range(size):
        change = still.copy()
        change[n] = _STEP
        a[:, n] = (rates_at(change, angle) - rates_at(-change, angle)) / (2 * _STEP)
        c[:, n] = (outputs_at(change, angle) - outputs_at(-change, angle)) / (2 * _STEP)
    b = (rates_at(still, angle + _STEP) - rates_at(still, angle - _STEP)) / (2 * _STEP)
    d = (outputs_at(still, angle + _STEP) - outputs_at(still, angle - _STEP)) / (2 * _STEP)
    for n in (0, 1):  # lateral velocity and yaw rate
        # The part -V'/V d of the docstring: only these two are divided by V in a slip angle.
        a[n, n] -= acceleration / point.speed
    states = tuple(INTEGRATED_PLACES[n].name for n in places)
    return LinearisedPlant(StateSpace(a, b[:, None], c, d[:, None]), states, state, acceleration)


def _moved(middle: np.ndarray, places: list[int], change: np.ndarray) -> np.ndarray:
    y = middle.copy()
    y[places] += change
    return y


def _parameters(point: OperatingPoint, initial_speed: float) -> PlanarPlantParameters:
    return PlanarPlantParameters(
        initial_speed=initial_speed,
        speed="free" if point.accelerates else "held",
        road=RoadParameters(left=(point.surface,), right=(point.surface,)),
    )


def _brought_to(vehicle: Vehicle, point: OperatingPoint) -> np.ndarray:
    """The state of a plant in the motion of the point."""
    # The plant reads its inputs from the one frame and writes its state to the other.
    here, there = Frame(), Frame()
    column = SteeringColumnState(0.0, 0.0, 0.0, point.road_wheel_angle, 0.0)
    for signal in (WheelTorqueCommand(point.drive), column):
        here.numbers[PLACES[type(signal)]] = numbers_of(shape_of(type(signal)).flat(signal))

    def plant_from(speed: float) -> CompiledPart:
        return CompiledPart(
            find_method("plant", "planar"), _parameters(point, speed), vehicle, _PERIOD
        )

    if not point.accelerates:
        plant = plant_from(point.speed)
        for _ in range(round(_SETTLING / _PERIOD)):
            plant.step(here, there)
        return plant.state
    force = sum(point.drive) / vehicle.wheel_radius
    # what a second of the acceleration gains, when wheels and loads have settled [m/s]
    run_up = force / vehicle.mass
    if not 0.0 < run_up < point.speed or point.road_wheel_angle != 0.0:
        raise ValueError(
            "an acceleration is linearised straight ahead, at a speed above that of its first"
            " second"
        )
    # It passes the speed after about a second of acceleration, settled in all but the speed itself.
    plant = plant_from(point.speed - run_up)
    # Drag or a weak drive may keep it below the speed for ever.
    longest = round(10 * _SETTLING / _PERIOD)
    while plant.state[VX] < point.speed and longest:
        plant.step(here, there)
        longest -= 1
    if not longest:
        raise ValueError(f"{sum(point.drive):g} N m do not bring the car to {point.speed:g} m/s")
    return plant.state


def _outputs(vehicle: Vehicle, y: np.ndarray, angle: float) -> np.ndarray:
    """OUTPUTS at a state; slip angles as Zhileykin (2018) counts them, positive in a left turn."""
    u, v, r = y[VX], y[VY], y[YAW_RATE]
    rear_arm = vehicle.centre_of_mass_to_rear_axle
    front_arm = vehicle.wheelbase - rear_arm
    return np.array(
        # Against the axes of ISO, in which a slip angle to the left of the wheel is positive.
        [v, r, angle - math.atan((v + front_arm * r) / u), -math.atan((v - rear_arm * r) / u)]
    )


def bode_figure(model: SideSlipModel, plant: LinearisedPlant) -> Sheet:
    """Magnitude and phase of dA/delta: W12, W12 with the steering rate that it drops, and the linearised plant."""
    omega = 2 * np.pi * _FREQUENCIES
    # Beside W12 both what it drops by itself and all that the plant has besides.
    curves = {
        "W12 with the steering rate": _decibels(model.response_with_steering_rate(omega)),
        "planar plant, linearised": _decibels(plant.slip_angle_difference(omega)),
    }
    if model.excitation:  # a car that steers neutrally has no W12 to draw
        _, *w12 = bode(model.transfer_function(), omega)
        curves = {"W12": tuple(w12), **curves}
    title = f"Slip angles of rear minus front axle over the road-wheel angle, {model.speed:g} m/s"

    def over_frequency(axes: Axes) -> None:
        axes.set_xscale("log")
        axes.grid(True, which="minor")

    panels = [
        Panel(
            f"{title}: {part}",
            f"{part} [{unit}]",
            [Curve(_FREQUENCIES, values[number], label) for label, values in curves.items()],
            ground=over_frequency,
        )
        for number, (part, unit) in enumerate((("magnitude", "dB"), ("phase", "deg")))
    ]
    return Sheet(panels, "frequency [Hz]", columns=1)


def _decibels(response: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Magnitude [dB] and phase without jumps [deg]."""
    return 20 * np.log10(np.abs(response)), np.degrees(np.unwrap(np.angle(response)))
