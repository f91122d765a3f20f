"""Parameters of the nodes.

Described with unit and range, changed as a whole and live, or refused with a reason.
"""

from collections.abc import Iterator
from typing import Any

import pytest
from helpers.ros_graph import node_of, ros_domain
from rcl_interfaces.msg import Parameter as ParameterMessage
from rcl_interfaces.msg import ParameterType, ParameterValue
from rcl_interfaces.srv import SetParameters, SetParametersAtomically
from rclpy.parameter import Parameter
from std_srvs.srv import Trigger

from ev_core.lockstep.inbox import note_answer
from ev_core.methods.register import all_methods
from ev_core.parameters.declaration import entries
from ev_msgs_py.contract.roles import ROLES
from ev_nodes.stepping.runner_line import RUNNER_LINE
from ev_nodes.stepping.spinning import refuse_what_raises
from ev_stack.recording.run_recorder import RecorderParameters
from ev_stack.running.node_reports import NodeReports

pytestmark = pytest.mark.slow

LAW = "electronic_differential"
EVERY_METHOD = [(role, name) for role, methods in all_methods().items() for name in methods]


@pytest.fixture(scope="module")
def context() -> Iterator[Any]:
    with ros_domain() as context:
        yield context


@pytest.fixture
def law(context) -> Iterator[Any]:
    node = node_of(context, LAW, {"method": "steer_by_wire"})
    yield node
    node.destroy_node()


def tried(node: Any, **values: Any) -> str:
    """Set all at once, as ros2 param load does; what the node says against it, empty if nothing."""
    parameters = [Parameter(name.replace("__", "."), value=value) for name, value in values.items()]
    result = node.set_parameters_atomically(parameters)
    assert result.successful == (not result.reason)
    return result.reason


# Of a gateway: the car with the gear between its machines and the wheels, and a step of whole
# cycles of the bus.
NEEDED = {"inverter_gateway": {"vehicle.gear_ratio": 7.4, "control_period": 0.005}}


@pytest.mark.parametrize("name", [*ROLES, "recorder"])
def test_every_parameter_is_described_with_unit_and_range(context, name, tmp_path):
    node = node_of(
        context,
        name,
        NEEDED.get(name, {}) | ({"directory": str(tmp_path)} if name == "recorder" else {}),
    )
    declared = entries(RecorderParameters) if name == "recorder" else node.configuration.entries()
    assert len(declared) > 5
    for entry in declared:
        shown = node.describe_parameter(entry.name)
        assert shown.description.startswith(entry.spec.about)
        assert entry.spec.allowed in shown.additional_constraints
        assert f"[{entry.spec.unit}]" in shown.description or not entry.spec.unit
        assert shown.read_only == entry.spec.read_only
        ranges = [*shown.floating_point_range, *shown.integer_range]
        if not entry.is_array and entry.spec.low is not None:
            assert ranges[0].from_value == entry.spec.low
        if not entry.is_array and entry.spec.high is not None:
            assert ranges[0].to_value == entry.spec.high
    node.destroy_node()


def test_a_described_parameter_in_full(context, law):
    """`ros2 param describe` shows type, text, range and constraint."""
    shown = law.describe_parameter("natural_frequency")
    assert shown.type == ParameterType.PARAMETER_DOUBLE
    assert shown.description == "natural frequency of the servo, w_0 [rad/s] (assumption)"
    assert [(r.from_value, r.to_value) for r in shown.floating_point_range] == [(0.1, 100.0)]
    assert shown.additional_constraints == "allowed: 0.1 to 100 rad/s"


@pytest.mark.parametrize("count", [3, 3500, 20000])
def test_a_change_of_any_length_is_reported_to_the_runner(context, monkeypatch, count):
    """The report is cut: all values would not fit into a message, or not into the socket."""
    reports = NodeReports("/ev")
    address, _ = reports.line("driver")
    monkeypatch.setenv(RUNNER_LINE, address)
    node = node_of(context, "driver", {})
    times = [n / count / 7 for n in range(count)]
    assert (
        tried(node, speed_profile__time=times, speed_profile__speed=[10.0 + each for each in times])
        == ""
    )
    reports.look()
    assert len(reports.warnings) == 1
    assert reports.warnings[0].endswith("the run is not reproducible")
    assert len(reports.warnings[0]) < 250
    node.destroy_node()
    reports.close()


OPTIONS = [
    (role, name, switch)
    for role, methods in all_methods().items()
    for name, method in methods.items()
    for switch in method.switches
]


@pytest.mark.parametrize(("role", "name", "switch"), OPTIONS)
def test_an_option_of_a_law_is_fixed_when_its_node_starts(context, role, name, switch):
    """It decides which topics the node has."""
    node = node_of(context, role, {"method": name})
    before = node.configuration
    assert "read-only" in tried(node, **{switch: True})
    assert node.configuration is before
    node.destroy_node()


def test_a_live_value_that_does_nothing_without_an_option_is_refused(context):
    """It names the option, and does not count as a change of the run."""
    node = node_of(context, "plant", {"method": "planar"})
    part = node.stepper.part
    refusal = "plant method planar does not have it, expected with planar and plant.speed_mode true"
    assert refusal in tried(node, speed_control__gain=5.0)
    assert node.stepper.part is part
    node.destroy_node()
    node = node_of(context, "plant", {"method": "planar", "speed_mode": True})
    assert tried(node, speed_control__gain=5.0) == ""
    node.destroy_node()


def test_one_callback_of_a_node_runs_at_a_time(context, law):
    """Executors with several threads ask the groups: a change of parameters swaps the part.

    A message in another thread would step the part that is just being left.
    """
    first, *others = law.subscriptions
    assert others
    assert first.callback_group.beginning_execution(first)
    for entity in (*others, *law.services, *law.timers):
        assert not entity.callback_group.can_execute(entity)
    first.callback_group.ending_execution(first)
    for entity in (*others, *law.services, *law.timers):
        assert entity.callback_group.can_execute(entity)


def test_a_change_is_taken_over_live_and_the_state_lasts(law):
    before = law.stepper.part
    before.state = [3.0]  # the integral
    note_answer(law.stepper.inbox.steps, 0)
    assert tried(law, natural_frequency=9.0, max_torque_difference=80.0) == ""
    assert (
        law.get_parameter("natural_frequency").value
        == law.configuration.parameters.natural_frequency
        == 9.0
    )
    assert law.stepper.part is not before
    assert law.stepper.part.state == [3.0]


REFUSED = {
    "too low": ({"natural_frequency": 0.0}, "natural_frequency"),
    "too high": ({"natural_frequency": 1e6}, "natural_frequency"),
    "not a number": ({"natural_frequency": float("nan")}, "natural_frequency"),
    "infinite": ({"natural_frequency": float("inf")}, "natural_frequency"),
    "of another type": ({"natural_frequency": "fast"}, "type"),
    "read-only": ({"vehicle.mass": 1000.0}, "vehicle.mass"),
    "the method": ({"method": "equal_torque"}, "method"),
    "one good and one bad": ({"natural_frequency": 9.0, "damping_ratio": -1.0}, "damping_ratio"),
    "beside one of ROS": (
        {"natural_frequency": 9.0, "use_sim_time": True},
        "use_sim_time is refused beside",
    ),
}


def test_what_a_start_would_refuse_beside_the_period_is_refused_live(context):
    """No torque would act any more with a command that is given up within two periods."""
    node = node_of(context, "plant", {"mode": "realtime"})
    assert tried(node, command_timeout=0.001).startswith(
        "parameter command_timeout: 0.001 is refused, expected more"
    )
    assert tried(node, command_timeout=0.05) == ""
    assert node.configuration.extra.command_timeout == 0.05
    node.destroy_node()


@pytest.mark.parametrize(("values", "named"), REFUSED.values(), ids=REFUSED)
def test_a_bad_value_is_refused_with_a_reason_and_nothing_changes(law, values, named):
    configuration, played = law.configuration, law.stepper.part
    everything = {
        name: parameter.value for name, parameter in law.get_parameters_by_prefix("").items()
    }
    assert named in tried(law, **values)
    assert {
        name: parameter.value for name, parameter in law.get_parameters_by_prefix("").items()
    } == everything
    assert law.configuration is configuration
    assert law.stepper.part is played


def test_a_change_of_which_the_law_makes_an_error_of_any_kind_is_refused(law, monkeypatch):
    def fail(configuration, may_wait):
        raise ZeroDivisionError("float division by zero")

    monkeypatch.setattr(law, "new_part", fail)
    configuration, played = law.configuration, law.stepper.part
    assert tried(law, natural_frequency=9.0) == "float division by zero"
    assert (law.configuration, law.stepper.part) == (configuration, played)


def test_a_limit_of_real_time_is_that_of_the_start(context):
    """A plant has no torque if its command is too old in every step."""
    plant = node_of(context, "plant", {"mode": "realtime", "method": "kinematic"})
    assert tried(plant, command_timeout=0.02) == (
        "parameter command_timeout: 0.02 is refused, expected more than two control periods, 0.02 s"
    )
    assert tried(plant, command_timeout=0.021) == (
        "parameter command_ramp: 0.02 is refused, expected at most command_timeout less two control periods, 0.001 s, "
        "or the torque of every command has faded in part"
    )
    assert tried(plant, command_timeout=0.021, command_ramp=0.001) == ""
    plant.destroy_node()


def asked(node: Any, service: str, request: Any) -> Any:
    """Ask a service of a spinning node and return its answer."""
    refuse_what_raises(node)
    (found,) = [each for each in node.services if each.srv_name.endswith(f"/{service}")]
    return found.callback(request, found.srv_type.Response())


def no_type(name: str, kind: int) -> ParameterMessage:
    return ParameterMessage(name=name, value=ParameterValue(type=kind, double_value=3.0))


def test_no_request_of_any_service_ends_a_node_or_is_done_by_half(law):
    """A type that is none, names that are none, of one and of several values.

    And what a callback itself raises.
    """
    frequency = law.configuration.parameters.natural_frequency
    good = Parameter("natural_frequency", value=9.0).to_parameter_msg()
    for kind in (10, 77, 255):
        for wrong in (
            no_type("natural_frequency", kind),
            no_type("unknown", kind),
            no_type("", kind),
        ):
            each = asked(
                law, "set_parameters", SetParameters.Request(parameters=[good, wrong])
            ).results
            assert [(one.successful, f"{kind} is not a valid" in one.reason) for one in each] == [
                (False, True)
            ] * 2
            all_ = asked(
                law,
                "set_parameters_atomically",
                SetParametersAtomically.Request(parameters=[good, wrong]),
            )
            assert not all_.result.successful and f"{kind} is not a valid" in all_.result.reason
    assert law.configuration.parameters.natural_frequency == frequency
    for service in law.services:
        service.callback._callback = lambda *_: {}[1]
        answer = service.callback(service.srv_type.Request(), service.srv_type.Response())
        assert type(answer) is service.srv_type.Response


def test_a_service_that_raises_says_why(context):
    plant = node_of(context, "plant", {"method": "kinematic"})
    plant.stepper.begin_run = lambda: {}["nothing"]
    answer = asked(plant, "reset", Trigger.Request())
    assert (answer.success, answer.message) == (False, "refused: 'nothing'")
    plant.destroy_node()


def test_an_unknown_choice_lists_the_known_ones(context):
    driver = node_of(context, "driver", {})
    assert "hand_torque, angle" in tried(driver, steering__mode="elbow")
    driver.destroy_node()


def test_values_that_belong_together_change_together(context):
    """Times and speeds of a profile have the same number, so neither can change in length alone."""
    driver = node_of(context, "driver", {})
    assert "same number" in tried(driver, speed_profile__time=[0.0, 1.0, 2.0])
    assert (
        tried(driver, speed_profile__time=[0.0, 1.0, 2.0], speed_profile__speed=[0.0, 1.0, 1.0])
        == ""
    )
    assert driver.configuration.parameters.speed_profile.speed == (0.0, 1.0, 1.0)
    driver.destroy_node()


def test_how_time_runs_can_change_without_touching_the_plant(context):
    plant = node_of(context, "plant", {})
    played = plant.stepper.part
    assert tried(plant, real_time_factor=2.0) == ""
    assert plant.configuration.extra.real_time_factor == 2.0
    assert plant.stepper.part is played
    plant.destroy_node()
