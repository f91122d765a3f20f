"""The two readings of the motor data of Shchur (2019)."""

import pytest
from drives.bench import CONTROLS, name_of, run

from ev_core.parameters.values import build
from ev_sim.drives.brushless_motor import MotorParameters, phase_of, torque_constant

OF_A_PHASE = {"motor.resistance": 0.075, "motor.inductance": 0.004, "motor.flux_linkage": 0.1}


def test_the_armature_winding_is_two_phases_in_series():
    """R, L and psi of each phase are half of those, and 2 p psi of a phase is p psi of both."""
    motor = build(MotorParameters, {})
    assert phase_of(motor) == pytest.approx((0.075, 0.004, 0.1))
    assert torque_constant(motor) == pytest.approx(10 * 0.2)
    assert torque_constant(build(MotorParameters, {"winding": "phase"})) == pytest.approx(20 * 0.2)


@pytest.mark.parametrize("changes", CONTROLS, ids=name_of)
@pytest.mark.parametrize("torque", [12.0, -12.0])
def test_a_motor_is_the_same_by_either_reading(changes, torque):
    """The same phases by both readings: equal to the bit, as a half of a number is exact."""
    of_armature = run({**changes, "motor.winding": "armature"}, torque, 40.0, duration=0.02)
    of_phases = run({**changes, **OF_A_PHASE}, torque, 40.0, duration=0.02)
    assert (of_armature.mean_torque == of_phases.mean_torque).all()
    assert (of_armature.electrical_power == of_phases.electrical_power).all()
