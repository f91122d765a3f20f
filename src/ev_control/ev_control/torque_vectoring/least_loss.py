"""Wheel torques with the least loss of motors and inverters, within what motors can give and tyres can hold.

Drive torque and yaw moment fix what the wheels of each side get together, and front and rear share it so that their
loss is least. With equal motors and a loss that grows with the square of the torque both get the same. Where the loss
first rises steeply, one of them gets all up to a switching torque: Dizqah et al. (2016), A fast and parametric torque
distribution strategy for four-wheel-drive energy-efficient electric vehicles, IEEE Trans. Industrial Electronics 63(7);
De Filippis et al. (2018), Energy-efficient torque-vectoring control of electric vehicles with multiple drivetrains,
IEEE Trans. Vehicular Technology 67(6). Here the share is searched, so that motors need not be equal and bounds count.
"""

from ev_control.shared.allocation import Range
from ev_control.torque_vectoring.known_motion import KnownMotion
from ev_control.torque_vectoring.weighted_least_squares import (
    LeastSquaresParameters,
    least_squares,
    sliding_torques,
    wheel_range,
)
from ev_core.law import Car, Wheels, compilable
from ev_core.vehicle.losses import EfficiencyMap, loss_power, map_loss_power


@compilable
def least_loss(
    p: LeastSquaresParameters,
    car: Car,
    table: EfficiencyMap,
    motion: KnownMotion,
    speed: Wheels,
    total: float,
    moment: float,
) -> Wheels:
    """Torques of the driven wheels [N m] for a drive torque and a yaw moment [N m], at wheel speeds [rad/s].

    Each side gets what `least_squares` gives it, which decides where both demands do not fit.
    """
    u, grip = least_squares(p, car, motion, speed, total, moment), sliding_torques(car, motion)
    a, b = wheel_range(p, car, motion, speed, grip, 0), wheel_range(p, car, motion, speed, grip, 1)
    c, d = wheel_range(p, car, motion, speed, grip, 2), wheel_range(p, car, motion, speed, grip, 3)
    # One speed for both motors of a side: the noise of two would decide between equal losses, each time anew.
    front_left = front_torque(car, table, (speed[0] + speed[2]) / 2.0, u[0] + u[2], a, c)
    front_right = front_torque(car, table, (speed[1] + speed[3]) / 2.0, u[1] + u[3], b, d)
    return Wheels(front_left, front_right, (u[0] + u[2]) - front_left, (u[1] + u[3]) - front_right)


POINTS = 16  # of the first round, besides its end
ROUNDS = 6  # each a quarter as wide as the one before: to 1/16384 of the range


@compilable
def front_torque(car: Car, table: EfficiencyMap, speed: float, both: float, front: Range, rear: Range) -> float:
    """The torque of the front wheel of a side [N m] with which both its wheels, that get `both`, lose least.

    The best of equally spaced points, then around it of points that are closer; or that of one wheel which does all,
    because a motor without torque may lose nothing. Of equal losses the first.
    """
    low, high = max(front.least, both - rear.most), min(front.most, both - rear.least)
    start, step, points, best = low, (high - low) / POINTS, POINTS, low
    least = side_loss(car, table, speed, low, both)
    for _ in range(ROUNDS):
        for n in range(points + 1):
            here = min(max(start + n * step, low), high)
            loss = side_loss(car, table, speed, here, both)
            if loss < least:
                best, least = here, loss
        start, step, points = best - step, step / 4.0, 8
    for n in range(2):
        alone = min(max(n * both, low), high)
        loss = side_loss(car, table, speed, alone, both)
        if loss < least:
            best, least = alone, loss
    return best


@compilable
def side_loss(car: Car, table: EfficiencyMap, speed: float, front: float, both: float) -> float:
    """Loss of the motors of a side [W] at a wheel speed [rad/s]."""
    return wheel_loss(car, table, 0, front, speed) + wheel_loss(car, table, 2, both - front, speed)


@compilable
def wheel_loss(car: Car, table: EfficiencyMap, wheel: int, torque: float, speed: float) -> float:
    """Loss of the motors of a wheel [W], at its torque before the gear's losses [N m] and its speed [rad/s]."""
    if car.driven[wheel] == 0.0:
        return 0.0
    shaft, turns = torque / (car.gear[wheel] * car.motors[wheel]), speed * car.gear[wheel]
    if len(table.efficiency) > 0:
        return car.motors[wheel] * map_loss_power(shaft, turns, table.speed, table.torque, table.efficiency)
    return car.motors[wheel] * loss_power(car.motor, shaft, turns)
