"""Methods that break the contract are found, and the error says how; a good one passes."""

from __future__ import annotations

import dataclasses
import re
from dataclasses import dataclass

import pytest
from check.bad_methods import (
    FINDINGS,
    WRAPPING,
    AnsweringNan,
    Good,
    Hiding,
    Leaning,
    Sleeping,
    configuration_of,
)

from ev_core.check.method import ContractError, check_configuration, check_method
from ev_core.check.mirror import mirrored_configuration, mirrored_numbers
from ev_core.check.stepping import ExtremeInputs, RandomInputs
from ev_core.law import WHEEL_NAMES, ParameterError, Wheels, parameter
from ev_core.lockstep.configuration import configure
from ev_msgs_py.contract.fields import shape_of
from ev_msgs_py.contract.signals import (
    BatteryCondition,
    BodyPose,
    BodyVelocity,
    DriverCommand,
    SteeringColumnState,
    TireForces,
    WheelTorqueRequest,
)

pytestmark = pytest.mark.slow


def found_in(factory) -> tuple[str, ...]:
    with pytest.raises(ContractError) as error:
        check_configuration(configuration_of(factory))
    return error.value.findings


def test_a_good_method_passes():
    check_configuration(configuration_of(Good))


@pytest.mark.parametrize(
    ("factory", "finding"), FINDINGS, ids=[getattr(bad, "__name__", "law") for bad, _ in FINDINGS]
)
def test_what_is_wrong_is_found(factory, finding):
    """It comes first.

    Others may follow from it: a random answer differs in the mirror and after loading as well.
    """
    assert finding in found_in(factory)[0]


def test_the_error_lists_all_findings():
    class Both(Hiding):
        def answer(self, request):
            return (
                super()
                .answer(request)
                ._replace(drive=Wheels(super().answer(request).drive[0], 0.0, 0.0, 0.0))
            )

    findings = found_in(Both)
    assert [finding.partition(", ")[2][:9] for finding in findings] == [
        "the state",
        "parameter",
        "left and ",
    ]
    with pytest.raises(
        ContractError,
        match=r"asr method toy breaks the contract:\n- in plain Python, .*\n- in plain",
    ):
        check_configuration(configuration_of(Both))


def test_a_finding_names_step_channel_and_values():
    assert "step" in found_in(Leaning)[0]
    assert "WheelTorqueCommand.drive.front_" in found_in(Leaning)[0]
    assert found_in(AnsweringNan)[0].startswith("in plain Python, plausible inputs, step ")


def test_symmetry_is_checked_where_it_is_claimed():
    class Modest(Leaning):
        mirrored = False

    check_configuration(configuration_of(Modest))
    check_configuration(configuration_of(Leaning), mirrored=False)


def test_difference_of_compiled_code_says_where():
    (finding,) = found_in(WRAPPING)
    assert finding.startswith(
        "compiled and interpreted differ, step 0: WheelTorqueCommand.drive.front_left is "
    )


def test_what_was_never_called_is_a_finding_and_what_was_reached_is_reported():
    """A whole check lists uncalled functions as a finding, a smaller one in its report."""
    configuration = configuration_of(Sleeping)
    with pytest.raises(
        ContractError, match=r"\n- in 200 steps for each of 2 seeds never called: Sleeping\.work \("
    ):
        check_configuration(configuration, whole=True)
    of = check_configuration(configuration)
    assert [name.partition(" ")[0] for name in of.never_called] == ["Sleeping.work"]
    (line,) = [line for line in str(of).splitlines() if line.startswith("bad_methods.py: ")]
    assert re.search(r"\d+ of \d+ lines, line \d+ 400 times.*; never \d+$", line)
    assert check_configuration(configuration_of(Good), whole=True).never_called == ()


def test_the_pedal_is_free_and_pressed_and_a_brake_never_negative():
    """The pedal is free in many steps: some laws look at nothing but a pressed brake."""
    inputs = RandomInputs((WheelTorqueRequest, DriverCommand), 1, 0.01)
    signals = [inputs.next() for _ in range(400)]
    brakes = [(*request.brake, driver.brake_torque) for request, driver in signals]
    assert min(map(min, brakes)) == 0.0
    assert 0.3 < sum(max(each) == 0.0 for each in brakes) / len(brakes) < 0.9


def test_unknown_methods_and_values_are_refused_as_everywhere():
    with pytest.raises(ParameterError, match="unknown asr method 'of'"):
        check_method("asr", "of")
    with pytest.raises(ParameterError, match=r"regulator\.target"):
        check_method("asr", "pi_slip", {"regulator.target": 7.0})
    with pytest.raises(
        ParameterError, match=r"method pi_slip does not have it, its name there is regulator"
    ):
        check_method("asr", "pi_slip", {"reference.trust.watch": True})


# The mirror image


def mirrored(signal):
    shape = shape_of(type(signal))
    return shape.signal_of(mirrored_numbers(type(signal), shape.flat(signal)))


def test_what_turns_or_points_to_the_left_changes_its_sign():
    assert mirrored(DriverCommand(1.0, 2.0, 3.0)) == DriverCommand(1.0, 2.0, -3.0)
    assert mirrored(SteeringColumnState(1.0, 2.0, 3.0, 4.0, 5.0)) == SteeringColumnState(
        -1.0, -2.0, -3.0, -4.0, -5.0
    )
    assert mirrored(BodyVelocity(1.0, 2.0, 3.0)) == BodyVelocity(1.0, -2.0, -3.0)
    assert mirrored(BatteryCondition(1.0, 2.0, 3.0, 4.0, 5.0)) == BatteryCondition(
        1.0, 2.0, 3.0, 4.0, 5.0
    )


def test_heading_is_negated():
    pose = mirrored(BodyPose.at(1.0, 2.0, 0.3))
    assert (pose.x, pose.y, pose.heading) == (1.0, -2.0, -0.3)


def test_wheels_change_sides():
    rows = [
        Wheels(10.0 * n + 1.0, 10.0 * n + 2.0, 10.0 * n + 3.0, 10.0 * n + 4.0) for n in range(6)
    ]
    image = mirrored(TireForces(*rows))
    assert image.longitudinal_force == Wheels(2.0, 1.0, 4.0, 3.0)
    assert image.lateral_force == Wheels(-12.0, -11.0, -14.0, -13.0)
    assert image.load == Wheels(22.0, 21.0, 24.0, 23.0)
    assert image.slip_angle == Wheels(-42.0, -41.0, -44.0, -43.0)


def test_parameters_have_a_mirror_image():
    values = {
        "method": "planar",
        "vehicle.driven_wheels": ["front_left", "rear_right"],
        "vehicle.centre_of_mass_offset": 0.1,
        "road.left": ["ice"],
        "initial_heading": 0.2,
    }
    image = mirrored_configuration(configure("plant", values))
    assert image.common.vehicle.driven_wheels == ("front_right", "rear_left")
    assert image.common.vehicle.centre_of_mass_offset == -0.1
    assert (image.parameters.road.left, image.parameters.road.right) == (("dry_asphalt",), ("ice",))
    assert image.parameters.initial_heading == -0.2
    assert mirrored_configuration(image) == configure("plant", values)


def test_values_by_wheel_change_sides():
    law = configure(
        "electronic_differential",
        {"method": "load_proportional", "rolling_resistance": [1, 2, 3, 4]},
    )
    assert mirrored_configuration(law).parameters.rolling_resistance == (2.0, 1.0, 4.0, 3.0)


def test_what_names_a_wheel_or_a_side_names_the_other_one():
    """One by one as in arrays, and in the faults of the car.

    A wheel that was named alone stayed where it was.
    """

    @dataclass(frozen=True, slots=True)
    class Named:
        wheel: str = parameter("rear_left", choices=WHEEL_NAMES, about="one wheel")
        side: str = parameter("left", choices=("both", "left", "right"), about="one side")
        left_handed: bool = parameter(True, about="has no counterpart")

    image = mirrored_configuration(configuration_of(Good, Named)).parameters
    assert (image.wheel, image.side, image.left_handed) == ("rear_right", "right", True)
    car = configure(
        "plant", {"method": "planar", "faults": ["motor_share front_left 0", "puncture right 1"]}
    )
    assert mirrored_configuration(car).faults == ("motor_share front_right 0", "puncture left 1")


# What the method is given


def test_absurd_numbers_are_among_plausible_ones_and_finite():
    """About a third of them: 30 % are drawn as absurd, a tenth of these is zero."""
    inputs = ExtremeInputs((TireForces,), 1, 0.01)
    signals = [inputs.next()[0] for _ in range(200)]
    numbers = [abs(number) for signal in signals for number in shape_of(TireForces).flat(signal)]
    assert max(numbers) == 1.7976931348623157e308
    assert 0.1 < sum(number > 1e5 for number in numbers) / len(numbers) < 0.3
    assert min(load for signal in signals for load in signal.load) >= 0.0
    assert len(WHEEL_NAMES) == len(signals[0].load)


def test_absurd_numbers_fit_into_the_message():
    inputs = ExtremeInputs((BatteryCondition,), 1, 0.01)
    shape = shape_of(BatteryCondition)
    for _ in range(200):
        shape.refuse_not_finite(shape.flat(inputs.next()[0]))


@pytest.mark.parametrize("kind", [RandomInputs, ExtremeInputs])
def test_inputs_are_the_same_for_the_same_seed(kind):
    one, other = kind((TireForces,), 5, 0.01), kind((TireForces,), 5, 0.01)
    assert [one.next() for _ in range(20)] == [other.next() for _ in range(20)]


def test_dataclass_of_parameters_is_not_changed_by_the_check():
    configuration = configuration_of(Good)
    before = dataclasses.replace(configuration)
    check_configuration(configuration)
    assert configuration == before
