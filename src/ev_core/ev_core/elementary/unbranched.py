"""Functions without branches, for arguments of known range.

The compiler makes one evaluation of four numbers at once of a loop over the wheels that calls them.
Polynomials with the least largest relative error (Remez, Comptes rendus 198, 1934) of odd powers,
in the order of Estrin (Proc. Western Joint Computer Conference, 1960), in which terms do not wait
for each other.
"""

from ev_core.elementary.parts import HALF_PI, PI, QUARTER_PI
from ev_msgs_py.compilable import inlined

TAN_EIGHTH, TAN_3_EIGHTHS = 0.41421356237309503, 2.414213562373095  # of half a turn


@inlined
def first_quadrant(y: float, x: float) -> float:
    """Angle of the vector (x, y), x positive and y not negative, from the x axis.

    Relative error 1.2e-15.
    """
    outside, far = y > TAN_EIGHTH * x, y > TAN_3_EIGHTHS * x
    upper = y - x if outside else y
    lower = y + x if outside else x
    upper = -x if far else upper
    lower = y if far else lower
    head = QUARTER_PI if outside else 0.0
    head = HALF_PI if far else head
    t = upper / lower
    z = t * t
    w = z * z
    low = (0.9999999999999991 - 0.33333333333225407 * z) + w * (
        0.1999999997900519 - 0.14285712698124962 * z
    )
    middle = (0.11111049940905579 - 0.09089548190371417 * z) + w * (
        0.07673715177685765 - 0.06507016170673675 * z
    )
    high = 0.050279658828128836 - 0.025357884518240623 * z
    return head + t * (low + (w * w) * (middle + (w * w) * high))


@inlined
def rising_sine(x: float) -> float:
    """Sine of an angle between -pi/2 and pi/2; relative error 5.6e-16."""
    z = x * x
    w = z * z
    low = (0.9999999999999998 - 0.16666666666665965 * z) + w * (
        0.008333333333275925 - 0.00019841269823223028 * z
    )
    high = (2.755731642134257e-06 - 2.505187088601869e-08 * z) + w * (
        1.6047844697979439e-10 - 7.370663443167758e-13 * z
    )
    return x * (low + (w * w) * high)


@inlined
def sine_of_multiple(factor: float, y: float, x: float) -> float:
    """Sine of 0 to 3 times the angle of `first_quadrant`; absolute error 2e-15."""
    angle = factor * first_quadrant(y, x)
    back = PI - angle
    return rising_sine(back if back < angle else angle)


@inlined
def cosine_of_multiple(factor: float, y: float, x: float) -> float:
    """Cosine of 0 to 4 times the angle of `first_quadrant`; absolute error 2e-15."""
    angle = HALF_PI - factor * first_quadrant(y, x)
    back = -PI - angle
    return rising_sine(back if back > angle else angle)


@inlined
def moderate_exp(x: float) -> float:
    """e^x for |x| <= 4, by its series at a sixteenth of x; relative error 6.1e-15."""
    t = x * 0.0625
    w = t * t
    low = (1.0 + t) + w * (0.5 + t * 0.16666666666666666)
    middle = (0.041666666666666664 + t * 0.008333333333333333) + w * (
        0.001388888888888889 + t * 0.0001984126984126984
    )
    high = (2.48015873015873e-05 + t * 2.7557319223985893e-06) + w * (
        2.755731922398589e-07 + t * 2.505210838544172e-08
    )
    root = low + (w * w) * (middle + (w * w) * high)
    squared = root * root
    squared *= squared
    squared *= squared
    return squared * squared
