"""Reference results of the Modelica library PlanarMechanics: its cars as ours, and by its own equations.

Its front wheels and their carriers have mass and stand behind their kingpins by a trail, so
steering pushes the car sideways. The plant's wheels are steered without mass. Both are driven here:
the plant beside the results, and the equations of the library with our wheel curve, with the mass
where it is and with it on the kingpins' axle.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

from ev_core.parameters.data_file import find_in_config
from ev_msgs_py.refusal import ParameterError
from ev_sim.tyres.curve import dry_friction
from ev_stack.measures import motion
from ev_stack.recording.offline import run_offline
from ev_stack.scenarios.records import Overrides
from ev_study.measured.records.tables import read_columns
from ev_study.measured.replays.open_loop import graph

_SMOOTHING = 1e-4  # [m/s], which the library adds to every slip speed
PERIOD = 0.002  # [s] of the plant, that of the reference results


@dataclass(frozen=True)
class Wheel:
    """Kingpin or axle from the middle of the rear axle [m], load [N], drive torque [N m]."""

    x: float
    y: float
    load: float
    torque: float = 0.0
    steered: bool = False


@dataclass(frozen=True)
class Car:
    """A chassis with its mass on the rear axle, and carriers with mass behind the kingpins of the steered wheels.

    `friction` is that of `dry_friction`; `drag` [N s^2/m^2] acts at the front axle. SI.
    """

    length: float
    mass: float
    inertia: float
    carrier_mass: float
    carrier_inertia: float
    trail: float
    wheels: Sequence[Wheel]
    radius: float
    spin_inertia: float
    friction: tuple[float, float, float, float]
    drag: float = 0.0

    def with_mass_on_axle(self) -> Car:
        """The same car with carriers that steer without mass or inertia, at the places of their wheels."""
        moved = [replace(w, x=w.x - self.trail) if w.steered else w for w in self.wheels]
        return replace(
            self, wheels=moved, trail=0.0, carrier_inertia=1e-9, length=self.length - self.trail
        )


TWO_TRACK = Car(
    2.0, 300.0, 0.1, 100.0, 1.0, 0.05,
    (
        Wheel(2.0, 0.75, 1000.0, steered=True), Wheel(2.0, -0.75, 1000.0, steered=True),
        Wheel(0.0, 0.75, 1500.0, 12.5), Wheel(0.0, -0.75, 1500.0, 12.5),
    ),
    0.25, 1.0, (1.0, 0.1, 0.7, 0.3),
)  # fmt: skip
# Its wheels roll without slip: an adhesion that holds any force within 2 mm/s.
SINGLE_TRACK = Car(
    1.0, 10.0, 0.1, 2.0, 0.1, 0.1, (Wheel(1.0, 0.0, 1000.0, steered=True), Wheel(0.0, 0.0, 1000.0, 2.0)),
    0.3, 1e-3, (1.0, 0.1, 1.0, 0.3), drag=0.5 * 1.18 * 0.4 * 2.0,
)  # fmt: skip


def planar_mechanics(folder: Path) -> dict[str, float]:
    """Distances of ours from the results in planar_mechanics, by id [%].

    ParameterError if one is missing.
    """
    folder = folder / "planar_mechanics"
    two, one = (
        _reference(folder, name)
        for name in ("TwoTrackWithDifferentialGear", "SingleTrackWithEngine")
    )
    heading = one["bodyFront.phi"] - one["revolute.phi"]
    front = one["bodyFront.r[2]"] + 1j * -one["bodyFront.r[1]"]  # x ahead, y to the left
    # From the carrier's mass to its kingpin 0.1 m ahead, and back by the wheelbase of 1 m.
    rear = front - np.exp(1j * heading) + 0.1 * np.exp(1j * one["bodyFront.phi"])
    found = {}
    for name, car, time, angle, place, turned in (
        ("two_track", TWO_TRACK, two["Time"], -two["revolute2.phi"], two["body1.r[2]"] - 1j * two["body1.r[1]"],
         two["body1.phi"]),
        ("single_track", SINGLE_TRACK, one["Time"], one["revolute.phi"], rear, heading),
    ):  # fmt: skip
        there = np.array([place[-1], turned[-1]])
        plant = plant_at_end(name, car, time, angle)
        theirs, on_axle = (
            equations_at_end(each, time, angle) for each in (car, car.with_mass_on_axle())
        )
        found[f"{name}_place"], found[f"{name}_yaw"] = _apart(plant, there)
        found[f"{name}_equations"] = max(_apart(theirs, there))
        found[f"{name}_mass_on_axle"] = max(_apart(plant, on_axle))
    for name, adhesion, sliding, least in (
        # The first wheel has fixed slip speeds, the second one shares of the speed of its rim.
        ("TestDryFrictionWheel", 0.0, 0.0, (0.1, 0.3)),
        ("TestSlipBasedWheel", 0.04, 0.12, (0.05, 0.15)),
    ):
        reference = _reference(folder, name)
        angle, radius = wheel_on_arm(10.0, adhesion, sliding, least)
        there = [
            np.interp(10.0, reference["Time"], reference[n]) for n in ("body.phi", "prismatic.s")
        ]
        found[name] = 100.0 * max(abs(angle / there[0] - 1.0), abs(radius / there[1] - 1.0))
    return found


def _reference(folder: Path, name: str) -> Mapping[str, np.ndarray]:
    """The columns of a result, each instant once."""
    columns, *_ = read_columns(folder / f"{name}.csv.xz")
    columns = {key.strip('"'): values for key, values in columns.items()}
    # Events write an instant twice; an interpolation needs times that rise.
    once = np.append(True, np.diff(columns["Time"]) > 0.0)
    return {key: values[once] for key, values in columns.items()}


def _apart(ours: np.ndarray, theirs: np.ndarray) -> tuple[float, float]:
    """Distance of two places over that from the start, and difference of two yaw angles over theirs, in per cent."""
    place, yaw = 100.0 * np.abs(ours - theirs) / np.abs(theirs)
    return float(place), float(yaw)


def plant_at_end(name: str, car: Car, time: np.ndarray, angle: np.ndarray) -> np.ndarray:
    """The plant's place of the rear axle's middle, x + jy, and its yaw angle, under the steering angle of a result."""
    file = find_in_config(f"measured/planar_mechanics/{name}.yaml")
    if file is None:
        raise ParameterError(f"measured/planar_mechanics/{name}.yaml is in no config folder")
    instants = np.arange(round(time[-1] / PERIOD) + 2) * PERIOD
    torque = sum(wheel.torque for wheel in car.wheels)
    configurations = graph(str(file), PERIOD)
    # The vehicle file may have another mass than the library's car with its carriers: the same
    # acceleration needs torques in proportion.
    scale = configurations["plant"].common.vehicle.mass / (
        car.mass + car.carrier_mass * sum(w.steered for w in car.wheels)
    )
    values = [
        ("plant", "speed", "free"),
        ("plant", "initial_hold", 0.0),
        ("driver", "pedals.drive_torque", [scale * torque]),
        ("steering_column", "time", instants.tolist()),
        ("steering_column", "angle", np.interp(instants, time, angle).tolist()),
    ]
    run = run_offline(graph(str(file), PERIOD, Overrides(values=values)), float(time[-1]))
    heading = motion.heading(run)
    # The plant's place is that of the centre of mass; results are of the middle of the rear axle,
    # and begin at zero.
    to_rear = configurations["plant"].common.vehicle.centre_of_mass_to_rear_axle
    place = (
        run.channels["pose.x"]
        + 1j * run.channels["pose.y"]
        - to_rear * np.exp(1j * heading)
        + to_rear
    )
    return np.array([place[-1], heading[-1]])


def equations_at_end(car: Car, time: np.ndarray, angle: np.ndarray) -> np.ndarray:
    """The same by the equations of the library: Newton and Euler for chassis and carriers, wheels that slip."""
    steering = CubicSpline(time, angle)
    steering_rate, steering_acceleration = steering.derivative(), steering.derivative(2)

    def rates(t: float, y: np.ndarray) -> np.ndarray:
        # State: place of the middle of the rear axle, heading; their rates; spins of the wheels.
        # Vectors of the plane are complex numbers, x + jy.
        heading, (vx, vy, turning), spins = y[2], y[3:6], y[6:]
        along = np.exp(1j * heading)
        mass, force, spin_rates = (
            np.diag([car.mass, car.mass, car.inertia]),
            np.zeros(3),
            np.zeros(len(spins)),
        )
        at_front = vx + 1j * vy + turning * 1j * car.length * along
        # The part along the car; drag acts against it whatever its sign.
        dragged = (at_front * along.conjugate()).real
        force += _at(-car.drag * abs(dragged) * dragged * along, car.length * along)
        for i, wheel in enumerate(car.wheels):
            steered = float(wheel.steered)
            arm, direction = (
                (wheel.x + 1j * wheel.y) * along,
                along * np.exp(1j * steered * steering(t)),
            )
            # Behind the kingpin along the wheel, so it turns with the steering angle.
            trail = -steered * car.trail * direction
            both = turning + steered * steering_rate(t)
            velocity = vx + 1j * vy + turning * 1j * arm + both * 1j * trail
            place = arm + trail
            if wheel.steered:
                # The acceleration of the carrier that is there without any acceleration of the
                # chassis.
                known = (
                    -(turning**2) * arm - both**2 * trail + steering_acceleration(t) * 1j * trail
                )
                # By it the chassis accelerates the carrier: rows x and y, columns of the three
                # rates.
                lever = np.array([[1.0, 0.0, -place.imag], [0.0, 1.0, place.real]])
                mass = mass + car.carrier_mass * lever.T @ lever
                mass[2, 2] += car.carrier_inertia
                force -= car.carrier_mass * _at(known, place)
                force[2] -= car.carrier_inertia * steering_acceleration(t)
            # Along the wheel and across it, less the speed of the rim along it.
            slip = velocity * direction.conjugate() - car.radius * spins[i]
            pushed = -_friction(abs(slip), wheel.load, car.friction) * slip
            force += _at(pushed * direction, place)
            spin_rates[i] = (wheel.torque - car.radius * pushed.real) / car.spin_inertia
        return np.concatenate([y[3:6], np.linalg.solve(mass, force), spin_rates])

    # Everything begins at rest at the origin, the car along x.
    start = np.zeros(6 + len(car.wheels))
    # LSODA, since friction over slip speed is steep at rest: the wheels are stiff there.
    end = solve_ivp(rates, (0.0, time[-1]), start, method="LSODA", rtol=1e-6, atol=1e-8).y[:, -1]
    return np.array([end[0] + 1j * end[1], end[2]])


def _at(force: complex, place: complex) -> np.ndarray:
    """A force in the plane and its moment about the rear axle's middle."""
    return np.array([force.real, force.imag, (place.conjugate() * force).imag])


def _friction(speed: float, load: float, friction: tuple[float, float, float, float]) -> float:
    """Friction over slip speed [N s/m], smoothed at rest as in the library."""
    return load * dry_friction(speed + _SMOOTHING, *friction) / (speed + _SMOOTHING)


def wheel_on_arm(
    duration: float, adhesion: float, sliding: float, least: tuple[float, float]
) -> tuple[float, float]:
    """Angle [rad] and radius [m] of the library's wheel of 10 kg that drives round on an arm along which it may slide.

    Slip speeds of adhesion and sliding are these shares of the rim speed, at `least` these [m/s].
    """
    mass, inertia, radius, torque, load = 10.0, 1.0, 0.3, 2.0, 100.0

    def rates(_: float, y: np.ndarray) -> list[float]:
        _, turning, arm, leaving, spin = y
        rim = abs(radius * spin)
        speeds = max(adhesion * rim, least[0]), max(sliding * rim, least[1])
        along = -arm * turning - radius * spin
        friction = _friction(
            float(np.hypot(along, leaving)), load, (0.8, speeds[0], 0.4, speeds[1])
        )
        # Polar coordinates: -2 m r r' phi' is the Coriolis force, r phi'^2 the centrifugal
        # acceleration. The wheel has 1 kg m^2 about its axle.
        return [
            turning,
            (arm * friction * along - 2.0 * mass * arm * leaving * turning)
            / (mass * arm * arm + inertia),
            leaving,
            arm * turning**2 - friction * leaving / mass,
            torque + radius * friction * along,
        ]

    end = solve_ivp(
        rates, (0.0, duration), [0.0, 0.0, 1.0, 0.0, 0.0], method="LSODA", rtol=1e-8, atol=1e-10
    )
    return float(end.y[0, -1]), float(end.y[2, -1])
