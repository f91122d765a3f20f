"""A hydrodynamic torque converter in steady flow."""

from __future__ import annotations

from ev_msgs_py.compiling.compilable import compilable

# Speed ratio at which the stator runs free: there the converter's two torques meet, and those of the coupling begin.
COUPLING_POINT = 0.8831
# The steepest change of either torque with either speed, of a converter of size 1 and over the faster speed
# [N m s^2/rad^2]: that of the coupling at equal speeds.
STEEPEST = 18.4858e-3


@compilable
def converter_torques(size: float, pump: float, turbine: float) -> tuple[float, float]:
    """The torque that the pump takes and the one that the turbine gives [N m], at their speeds [rad/s].

    Kotwicki, "Dynamic models for torque converter equipped vehicles", SAE 820393 (1982): two quadratic forms in both
    speeds up to the coupling point, one beyond it; `size` [1] scales them. A turbine that turns faster than the pump
    drives it as a coupling does, at most as at the coupling point (assumption: the source ends at equal speeds). One
    that turns backwards counts as at rest (assumption).
    """
    slow = max(turbine, 0.0)
    if slow < COUPLING_POINT * pump:
        taken = 3.4325e-3 * pump * pump + 2.2210e-3 * pump * slow - 4.6041e-3 * slow * slow
        given = 5.7656e-3 * pump * pump + 0.3107e-3 * pump * slow - 5.4323e-3 * slow * slow
        return size * taken, size * given
    if slow <= pump:
        passed = size * _coupled(pump, slow)
        return passed, passed
    passed = -size * _coupled(slow, max(pump, COUPLING_POINT * slow))
    return passed, passed


@compilable
def _coupled(fast: float, slow: float) -> float:
    """The torque from the faster to the slower side of a converter of size 1 beyond its coupling point [N m]."""
    return max(-6.7644e-3 * fast * fast + 32.0024e-3 * fast * slow - 25.2441e-3 * slow * slow, 0.0)
