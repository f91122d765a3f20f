"""python -m ev_study.analysis VEHICLE [options]"""

from __future__ import annotations

import argparse
import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ev_core.vehicle.description import GRAVITY, Vehicle
from ev_msgs_py.contract.wheels import WHEEL_NAMES, Wheels
from ev_msgs_py.refusal import ParameterError
from ev_sim.surfaces import REFERENCE, SURFACES
from ev_sim.understeer import (
    axle_cornering_stiffnesses,
    axle_masses,
    characteristic_speed,
    critical_speed,
    understeer_gradient,
)
from ev_stack.command_line.numbers import real
from ev_stack.command_line.paths import add_out
from ev_stack.command_line.refusal import Parser, refuse
from ev_stack.figures.saving import save_figures
from ev_stack.recording.recording import atomic_file
from ev_stack.running.output_folder import output_folder
from ev_stack.scenarios.files import vehicle_of
from ev_study.analysis.linear_models import (
    SideSlipModel,
    side_slip_model,
    single_track,
    tangent_speed,
    yaw_damping,
    yaw_gain,
)
from ev_study.analysis.linearised_plant import (
    OUTPUTS,
    LinearisedPlant,
    OperatingPoint,
    bode_figure,
    linearised,
)

_SPEEDS = (5.0, 10.0, 15.0, 20.0, 25.0, 30.0, 35.0, 40.0)  # [m/s] of the table


def main(argv: Sequence[str] | None = None) -> None:
    """Print how a vehicle steers by its linear models, and write the Bode figure beside the linearised plant's."""
    given = _arguments(argv)
    try:
        vehicle = vehicle_of(given.vehicle)
        drive = drive_torques(vehicle, given.drive_force)
        angle = math.radians(given.road_wheel_angle)
        plant = linearised(
            vehicle, OperatingPoint(given.speed, angle, drive, given.accelerates, given.surface)
        )
    except ValueError as error:  # also a ParameterError
        refuse(error)
    # The front share h of the source; without a force there is nothing to share.
    share = (drive.front_left + drive.front_right) / sum(drive) if given.drive_force else 0.0
    model = side_slip_model(
        vehicle, given.speed, plant.acceleration, given.drive_force, share, given.surface
    )
    for label, value, unit in rows(vehicle, given.surface, model, plant):
        print(f"{label:52}{value:>12.5g} {unit}")
    print_over_speed(vehicle, given.surface)
    try:
        with output_folder(given.out, "analysis") as folder:
            matrices = folder / f"linearised_{vehicle.name}.npz"
            save_matrices(matrices, plant)
            figure = bode_figure(model, plant).figure()
            (path,) = save_figures({f"bode_{vehicle.name}": figure}, folder)
    except (ParameterError, OSError) as error:
        refuse(error)
    print(f"A, B, C, D: {matrices}")
    print(f"figure: {path}")


def print_over_speed(vehicle: Vehicle, surface: str) -> None:
    """Print yaw rate gain and damping of the single-track model over speed."""
    print(
        f"\n{'speed m/s':>10}{'yaw rate gain 1/s':>20}{'damping ratio 1':>18}{'frequency rad/s':>18}"
    )
    for speed in _SPEEDS:
        model = single_track(vehicle, speed, surface)
        ratio, frequency = yaw_damping(model)
        print(f"{speed:>10g}{yaw_gain(model):>20.4g}{ratio:>18.4g}{frequency:>18.4g}")
    if vehicle.suspension.rolls:
        print("damping and frequency are of the slowest motion, in which the body rolls as well")


def save_matrices(path: Path, plant: LinearisedPlant) -> None:
    """Save A, B, C, D of the linearised plant, and the names of its states and outputs, as a numpy archive."""
    system = plant.system
    with atomic_file(path) as file:
        np.savez(
            file,
            A=system.A,
            B=system.B,
            C=system.C,
            D=system.D,
            states=plant.states,
            outputs=OUTPUTS,
        )


def drive_torques(vehicle: Vehicle, force: float) -> Wheels:
    """Equal torques [N m] of the driven wheels for a drive force [N].

    Raises ParameterError if a force has no wheel.
    """
    driven = [name in vehicle.driven_wheels for name in WHEEL_NAMES]
    if force and not any(driven):
        raise ParameterError(f"vehicle {vehicle.name} has no driven wheels")
    each = force * vehicle.wheel_radius / max(sum(driven), 1)
    return Wheels(*(each if drives else 0.0 for drives in driven))


def rows(
    vehicle: Vehicle, surface: str, model: SideSlipModel, plant: LinearisedPlant
) -> list[tuple[str, float, str]]:
    """Rows to print: label, value, unit; speeds that the car has, W12 if a force drives the car."""
    front, rear = axle_masses(vehicle)
    front_stiffness, rear_stiffness = axle_cornering_stiffnesses(vehicle, surface)
    slow = np.array([0.0])
    yaw_gain = plant.response(slow)[0, 1].real
    # The slowest one decides how long the car swings; a positive one is an unstable car.
    poles = np.linalg.eigvals(plant.system.A)
    speeds = [
        ("characteristic speed", characteristic_speed(vehicle, surface), "m/s"),
        ("critical speed", critical_speed(vehicle, surface), "m/s"),
        ("tangent speed: no sideslip", tangent_speed(vehicle, surface), "m/s"),
    ]
    of_roll = [
        ("share of the front axle in the lateral load transfer", vehicle.front_share_of_roll, "1")
    ]
    if vehicle.suspension.rolls:
        gradient = vehicle.rolling_body.gradient(vehicle.suspension, GRAVITY)
        of_roll.append(("roll angle over lateral acceleration", gradient, "rad s^2/m"))
    side_slip = [
        ("acceleration", plant.acceleration, "m/s^2"),
        ("W12 of Zhileykin (2018), eq 3: damping D", model.damping, "1/s"),
        ("W12: excitation N, 0 if the car steers neutrally", model.excitation, "1/s"),
        ("W12: steady dA/delta", model.excitation / model.damping, "1"),
        (
            "front share that steers neutrally, 2 J_z/(m L^2)",
            model.neutral_share_of_acceleration,
            "1",
        ),
    ]
    return [
        ("mass on the front axle", front, "kg"),
        ("mass on the rear axle", rear, "kg"),
        ("cornering stiffness of the front axle", front_stiffness, "N/rad"),
        ("cornering stiffness of the rear axle", rear_stiffness, "N/rad"),
        ("understeer gradient", understeer_gradient(vehicle, surface), "rad s^2/m"),
        *of_roll,
        # An oversteering car has no characteristic speed, an understeering one no critical speed.
        *(row for row in speeds if math.isfinite(row[1])),
        ("speed of what follows", model.speed, "m/s"),
        *(side_slip if model.drive_force else ()),
        (
            "rear less front slip angle over road-wheel angle",
            float(plant.slip_angle_difference(slow)[0].real),
            "1",
        ),
        ("steady yaw rate gain of the linearised plant", float(yaw_gain), "1/s"),
        ("slowest pole of the linearised plant", float(poles.real.max()), "1/s"),
    ]


def _arguments(argv: Sequence[str] | None) -> argparse.Namespace:
    parser = Parser(
        prog="python -m ev_study.analysis",
        description=(
            "How a vehicle steers: understeer gradient, W12, the single-track model over speed, and"
            " the planar plant linearised numerically, saved as A, B, C, D."
        ),
    )
    parser.add_argument("vehicle", help="name of a file in config/vehicles, or path of your own")
    parser.add_argument(
        "--surface", default=REFERENCE, choices=sorted(SURFACES), help="default: %(default)s"
    )
    parser.add_argument(
        "--speed",
        type=real(0.1, 120.0),
        default=8.0,
        metavar="M/S",
        help="ahead; default: %(default)s",
    )
    parser.add_argument(
        "--road-wheel-angle",
        type=real(-90.0, 90.0),
        default=0.0,
        metavar="DEG",
        help="of steady cornering",
    )
    parser.add_argument(
        "--drive-force", type=real(), default=0.0, metavar="N", help="of all driven wheels, equal"
    )
    parser.add_argument(
        "--accelerates", action="store_true", help="by the drive force; otherwise the speed is held"
    )
    add_out(parser, "analysis")
    return parser.parse_args(argv)


if __name__ == "__main__":
    main()
