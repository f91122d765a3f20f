"""Wheel torques with the least loss, within what motors can give and tyres can hold.

Drive torque and yaw moment fix what the wheels of each side get together, and front and rear share
it so that their loss is least. With equal motors and a loss that grows with the square of the
torque both get the same. Where the loss first rises steeply, one of them gets all up to a switching
torque: Dizqah et al. (2016), A fast and parametric torque distribution strategy for
four-wheel-drive energy-efficient electric vehicles, IEEE Trans. Industrial Electronics 63(7); De
Filippis et al. (2018), Energy-efficient torque-vectoring control of electric vehicles with multiple
drivetrains, IEEE Trans. Vehicular Technology 67(6). Here the share is searched, so that motors need
not be equal and bounds count.
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

POINTS = 16  # of the first round, besides its end
ROUNDS = 6  # each a quarter as wide as the one before: to 1/16384 of the range


@compilable
def least_loss(
    p: LeastSquaresParameters,
    car: Car,
    table: EfficiencyMap,
    motion: KnownMotion,
    total: float,
    moment: float,
) -> Wheels:
    """Torques of the driven wheels [N m] for a drive torque and a yaw moment [N m].

    Each side gets what `least_squares` gives it, which decides where both demands do not fit.
    """
    u, speed = least_squares(p, car, motion, total, moment), motion.wheel_speed
    grip = sliding_torques(car, motion)
    a = wheel_range(p, car, motion, grip, 0)
    b = wheel_range(p, car, motion, grip, 1)
    c = wheel_range(p, car, motion, grip, 2)
    d = wheel_range(p, car, motion, grip, 3)
    left, right = u[0] + u[2], u[1] + u[3]
    # One speed for both motors of a side: the noise of two would decide between equal losses, and
    # differently in each step.
    front_left = front_torque(car, table, (speed[0] + speed[2]) / 2.0, left, a, c)
    front_right = front_torque(car, table, (speed[1] + speed[3]) / 2.0, right, b, d)
    return Wheels(front_left, front_right, left - front_left, right - front_right)


@compilable
def front_torque(
    car: Car, table: EfficiencyMap, speed: float, both: float, front: Range, rear: Range
) -> float:
    """Torque [N m] of the front wheel of a side with which its wheels, that get `both`, lose least.

    The best of equally spaced points, then around it of points that are closer; or that of one
    wheel which does all, because a motor without torque may lose nothing. Of equal losses the
    first.
    """
    low = max(front.least, both - rear.most)
    high = min(front.most, both - rear.least)
    start = best = low
    step, points = (high - low) / POINTS, POINTS
    least = side_loss(car, table, speed, low, both)
    for _ in range(ROUNDS):
        for n in range(points + 1):
            here = min(max(start + n * step, low), high)
            loss = side_loss(car, table, speed, here, both)
            if loss < least:
                best = here
                least = loss
        start = best - step
        step /= 4.0
        points = 8
    # One wheel alone: none in front, or all.
    for n in range(2):
        alone = min(max(n * both, low), high)
        loss = side_loss(car, table, speed, alone, both)
        if loss < least:
            best = alone
            least = loss
    return best


@compilable
def side_loss(car: Car, table: EfficiencyMap, speed: float, front: float, both: float) -> float:
    """Loss of the motors of a side [W] at a wheel speed [rad/s]."""
    return wheel_loss(car, table, 0, front, speed) + wheel_loss(car, table, 2, both - front, speed)


@compilable
def wheel_loss(car: Car, table: EfficiencyMap, wheel: int, torque: float, speed: float) -> float:
    """Loss of the motors of a wheel [W] at its torque before the gear [N m] and speed [rad/s]."""
    if not car.driven[wheel]:
        return 0.0
    shaft = torque / (car.gear[wheel] * car.motors[wheel])
    turns = speed * car.gear[wheel]
    if len(table.efficiency) > 0:
        return car.motors[wheel] * map_loss_power(
            shaft, turns, table.speed, table.torque, table.efficiency
        )
    return car.motors[wheel] * loss_power(car.motor, shaft, turns)
