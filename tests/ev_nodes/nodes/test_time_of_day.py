"""Fast DDS can send nothing from 2038 on: a run over DDS is refused with that reason."""

import pytest
from rclpy.impl.implementation_singleton import rclpy_implementation

from ev_nodes.run_role import one_line
from ev_nodes.stepping import time_of_day
from ev_nodes.stepping.time_of_day import refuse_late_time_of_day, too_late
from ev_stack.recording.outcome import RunFailed
from ev_stack.running.node_reports import observing

LAST = 2**31 - 1
REFUSED = (
    "the time of day: 2038-01-19 03:14:08 UTC is past what Fast DDS can send, "
    "expected up to 2038-01-19 03:14:07, or another middleware"
)


@pytest.fixture
def at(monkeypatch):
    """Sets time of day and middleware."""

    def is_it(now: float, middleware: str = "rmw_fastrtps_cpp") -> None:
        monkeypatch.setattr(time_of_day.time, "time", lambda: now)
        monkeypatch.setattr(time_of_day, "get_rmw_implementation_identifier", lambda: middleware)

    return is_it


def test_the_last_second_is_allowed_and_the_next_one_is_not(at):
    """A stamp has 32 bits for the seconds, one of them for the sign."""
    at(LAST)
    refuse_late_time_of_day()
    at(LAST + 1)
    with pytest.raises(RuntimeError, match="^" + REFUSED):
        refuse_late_time_of_day()


def test_other_middleware_may_be_able_to(at):
    at(LAST + 1, "rmw_cyclonedds_cpp")
    assert too_late() is None


def test_a_run_does_not_begin(at):
    at(LAST + 1)
    with pytest.raises(RunFailed, match="^" + REFUSED), observing("/ev", 0, "looker"):
        pass


def test_what_the_middleware_cannot_send_is_put_down_to_the_time_of_day_only_if_it_is_late(at):
    error = rclpy_implementation.RCLError(
        "Failed to publish: cannot publish data, at /project/src/rmw_publish.cpp:68"
    )
    at(LAST)
    assert one_line(error) == "Failed to publish: cannot publish data"
    at(LAST + 1)
    assert one_line(error) == f"Failed to publish: cannot publish data; {REFUSED}"
    assert one_line(ValueError("unknown parameter")) == "unknown parameter"
