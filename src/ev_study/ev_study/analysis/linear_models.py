"""Linear models of a car: the single track on its own tyres, and the slip angles of a driven car (Zhileykin 2018)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.signal import StateSpace, ZerosPolesGain

from ev_core.vehicle.description import GRAVITY, Vehicle
from ev_sim.surfaces import REFERENCE
from ev_sim.understeer import axle_cornering_stiffnesses, axle_masses, tyre_cornering_stiffnesses

_ROLL_ANGLE, _ROLL_RATE = 4, 5  # places in the state of a single track with roll


@dataclass(frozen=True, slots=True)
class Axle:
    """One axle: place [m] ahead of the centre of mass, and how it bends and slides."""

    place: float
    steered: float  # share of the road-wheel angle [1]
    stiffness: float  # C of both tyres [N/rad]
    carcass: float  # of both tyres [N/m]
    damping: float  # of both tyres [N s/m]
    turning: float  # angle that a side force adds, positive to the left [rad/N]


def single_track(vehicle: Vehicle, speed: float, surface: str = REFERENCE) -> StateSpace:
    """X' = A x + B delta, y = C x + D delta with x = lateral velocity, yaw rate, deflection of both axles' carcasses.

    A body that rolls adds roll angle and rate (ev_core/vehicle/suspension.py) and sways over the
    wheels: their velocity across is v + e phi'. Outputs are lateral velocity [m/s] and yaw rate
    [rad/s], speed [m/s] is constant and above zero. A tyre of first order (Rill 2006): u' = (C v_s
    - V k u)/(C + V d), F = k u + d u', with v_s across the wheel, which compliance steer turns. No
    rolling resistance, no drag, no load transfer, which do not act to first order.
    """
    rear = vehicle.centre_of_mass_to_rear_axle
    front_stiffness, rear_stiffness = tyre_cornering_stiffnesses(vehicle, surface)
    tyre, suspension = vehicle.tyre, vehicle.suspension
    carcass, damping = (
        2 * tyre.lateral_stiffness,
        2 * tyre.lateral_stiffness * tyre.lateral_damping_time,
    )
    # A positive side force is to the left. It turns the front wheels out of the bend, to the right,
    # and the rear wheels into it, to the left: both are understeer.
    front_turning, rear_turning = (
        -suspension.front_compliance_steer,
        suspension.rear_compliance_steer,
    )
    axles = (
        Axle(vehicle.wheelbase - rear, 1.0, front_stiffness, carcass, damping, front_turning),
        Axle(-rear, vehicle.rear_steering_ratio, rear_stiffness, carcass, damping, rear_turning),
    )
    size = 6 if suspension.rolls else 4
    body = vehicle.rolling_body
    a, b = np.zeros((size, size)), np.zeros((size, 1))
    # v' = sum(F)/m - V r, in axes that turn with the car.
    a[0, 1] = -speed
    for n, axle in enumerate(axles):
        # v_s as a row of the state, and by the road-wheel angle
        slip, by_angle = np.zeros(size), speed * axle.steered
        slip[0], slip[1], slip[2 + n] = -1.0, -axle.place, speed * axle.turning * axle.carcass
        if suspension.rolls:
            slip[_ROLL_RATE] = -body.lever
        # The denominator C + V d of the carcass.
        renewal = axle.stiffness + speed * axle.damping
        a[2 + n] = axle.stiffness / renewal * slip
        a[2 + n, 2 + n] -= speed * axle.carcass / renewal
        b[2 + n, 0] = axle.stiffness / renewal * by_angle
        # F = k u + d u', as a row of the state.
        force = axle.damping * a[2 + n]
        force[2 + n] += axle.carcass
        inertias = [(0, vehicle.mass), (1, vehicle.yaw_inertia / axle.place)]
        if body.lever != 0.0:
            # A side force rolls the body by e, as it turns the car by its place.
            inertias.append((_ROLL_RATE, body.inertia / body.lever))
        for state, inertia in inertias:
            a[state] += force / inertia
            b[state, 0] += axle.damping * b[2 + n, 0] / inertia
    if suspension.rolls:
        held = suspension.stiffness - body.weight * GRAVITY
        damping = suspension.front_roll_damping + suspension.rear_roll_damping
        a[_ROLL_ANGLE, _ROLL_RATE] = 1.0
        a[_ROLL_RATE, _ROLL_ANGLE] -= held / body.inertia
        a[_ROLL_RATE, _ROLL_RATE] -= damping / body.inertia
    return StateSpace(a, b, np.eye(2, size), np.zeros((2, 1)))


def yaw_gain(system: StateSpace) -> float:
    """Steady yaw rate over road-wheel angle [1/s]."""
    return float((system.D - system.C @ np.linalg.solve(system.A, system.B))[1, 0])


def yaw_damping(system: StateSpace) -> tuple[float, float]:
    """Damping ratio [1] and undamped frequency [rad/s] of the slowest pole and its partner.

    A complex pole has its conjugate. A real one is taken as of a pair with the next real one: a
    pair of one real pole and half of a complex pair is the motion of no car. Where the body rolls,
    the slowest motion is one of yaw and roll, or of the roll alone.
    """
    # By the real part: what dies out last.
    slowest, *others = sorted(np.linalg.eigvals(system.A), key=lambda pole: -pole.real)
    partner = next(pole for pole in others if (pole.imag == 0.0) == (slowest.imag == 0.0))
    product, total = (slowest * partner).real, -(slowest + partner).real
    # Two real poles of opposite sign, beyond the critical speed, are no oscillator.
    frequency = math.sqrt(product) if product > 0.0 else math.nan
    return total / (2.0 * frequency), frequency


def tangent_speed(vehicle: Vehicle, surface: str = REFERENCE) -> float:
    """Speed at which a car goes round a bend without sideslip at its centre of mass [m/s]: sqrt(b C_2/m_2).

    With C_2 as compliance steer leaves it; infinite for a car without load on its rear axle.
    """
    mass, stiffness = axle_masses(vehicle)[1], axle_cornering_stiffnesses(vehicle, surface)[1]
    return (
        math.sqrt(vehicle.centre_of_mass_to_rear_axle * stiffness / mass)
        if mass > 0.0
        else math.inf
    )


@dataclass(frozen=True, slots=True)
class SideSlipModel:
    """Rates of the slip angles d1, d2 of a car with a = b = L/2 that accelerates with j cos(phi) at speed V.

    Slip angles [rad] are positive in a left turn: d1 = Theta - (v + L r/2)/V, d2 = -(v - L r/2)/V,
    angles small. Each axle carries K d, and the drive force h X of the front axle acts along its
    wheels. M_z = (1 - h) X q B is positive against the turn and counts with L r = V (Theta + dA) as
    m_z = M_z/(J_z r). The rate of the steering angle is dropped. Zhileykin (2018), eqs 1 to 7; the
    lever B is as printed (a difference q of the rear forces has B/2).
    """

    wheelbase: float  # L [m]
    mass: float  # m [kg]
    yaw_inertia: float  # J_z [kg m^2]
    axle_cornering_stiffness: float  # K, of each axle [N/rad]
    speed: float  # V, above zero [m/s]
    longitudinal_acceleration: float = 0.0  # j cos(phi) [m/s^2]
    drive_force: float = 0.0  # X, of both axles [N]
    front_share: float = 0.0  # h [1]
    rear_difference: float = 0.0  # q = (lambda - 1)/(lambda + 1) [1]
    rear_track: float = 1.5  # B [m]
    yaw_rate: float = 1.0  # r at which m_z is taken, not zero [rad/s]

    @property
    def stabilising_moment(self) -> float:
        """M_z = (1 - h) X q B, positive against the turn [N m]."""
        return (1 - self.front_share) * self.drive_force * self.rear_difference * self.rear_track

    @property
    def moment_rate(self) -> float:
        """m_z = M_z/(J_z r) [1/s]."""
        return self.stabilising_moment / (self.yaw_inertia * self.yaw_rate)

    @property
    def damping(self) -> float:
        """D = K L^2/(2 V J_z) + j cos(phi)/V + m_z [1/s].

        The model is stable if it is above zero.
        """
        stiffness = (
            self.axle_cornering_stiffness * self.wheelbase**2 / (2 * self.speed * self.yaw_inertia)
        )
        return stiffness + self.longitudinal_acceleration / self.speed + self.moment_rate

    @property
    def excitation(self) -> float:
        """N = L^2 h X/(2 V J_z) - j cos(phi)/V - m_z [1/s].

        Zero means that the car steers neutrally.
        """
        drive = (
            self.wheelbase**2
            * self.front_share
            * self.drive_force
            / (2 * self.speed * self.yaw_inertia)
        )
        return drive - self.longitudinal_acceleration / self.speed - self.moment_rate

    @property
    def neutral_share_of_acceleration(self) -> float:
        """Front share h that makes the car steer neutrally if its drive alone accelerates it, 2 J_z/(m L^2) [1]."""
        return 2 * self.yaw_inertia / (self.mass * self.wheelbase**2)

    def transfer_function(self) -> ZerosPolesGain:
        """W12(s) = dA/Theta = N/(D + s), with dA = d2 - d1 (eq 3, and eq 6 with M_z).

        As pole and gain, because the gain N is zero where the car steers neutrally, and a numerator
        may not be.
        """
        return ZerosPolesGain([], [-self.damping], self.excitation)

    def response_with_steering_rate(self, frequency: np.ndarray) -> np.ndarray:
        """(N - j w)/(D + j w) [1]: W12 with the rate of the steering angle in d1', which the source drops."""
        return (self.excitation - 1j * frequency) / (self.damping + 1j * frequency)


def side_slip_model(
    vehicle: Vehicle,
    speed: float,
    longitudinal_acceleration: float,
    drive_force: float,
    front_share: float,
    surface: str = REFERENCE,
) -> SideSlipModel:
    """The model of a vehicle: both axles with the mean cornering stiffness at small slip, centre of mass in the middle.

    Speed [m/s], acceleration [m/s^2], drive force of both axles [N] and share of the front axle
    [1].
    """
    return SideSlipModel(
        wheelbase=vehicle.wheelbase,
        mass=vehicle.mass,
        yaw_inertia=vehicle.yaw_inertia,
        axle_cornering_stiffness=sum(axle_cornering_stiffnesses(vehicle, surface)) / 2,
        speed=speed,
        longitudinal_acceleration=longitudinal_acceleration,
        drive_force=drive_force,
        front_share=front_share,
        rear_track=vehicle.rear_track,
    )
