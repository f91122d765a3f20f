"""A run gets a ROS domain of its own."""

import os
import socket
from contextlib import suppress

import pytest

from ev_stack.recording.outcome import RunFailed
from ev_stack.running import domain
from ev_stack.running.domain import NoFreeDomain, free_domain, own_namespace, reserved_domains

FIRST_PORTS = range(2000, 7000, 1000)  # far below those of DDS and those that sockets get by chance


@pytest.fixture(autouse=True)
def first_port(monkeypatch, tmp_path):
    """Three domains at ports that no run uses, nor a test beside this one.

    It would hold the first of them.
    """
    monkeypatch.setattr(domain, "_DOMAINS", range(1, 4))
    monkeypatch.setattr(domain.tempfile, "gettempdir", lambda: str(tmp_path))
    for port in FIRST_PORTS:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as held, suppress(OSError):
            held.bind(("", port))
            monkeypatch.setattr(domain, "_FIRST_PORT", port)
            yield port
            return
    pytest.fail(f"the ports {[*FIRST_PORTS]} are all in use")


def test_runs_at_the_same_time_get_different_domains():
    with free_domain() as first, free_domain() as second:
        assert {first, second} == {1, 2}
        assert reserved_domains() == [1, 2]
    assert reserved_domains() == []


def test_in_a_domain_of_the_users_a_second_run_needs_another_namespace(monkeypatch):
    monkeypatch.setenv("ROS_DOMAIN_ID", "2")
    with free_domain() as given, own_namespace(given, "/ev"):
        with free_domain() as again, own_namespace(again, "/ev/all_equal"):
            assert again == given == 2
        refused = "^ROS domain 2 has a run in the namespace /ev already"
        with (
            free_domain() as again,
            pytest.raises(RunFailed, match=refused),
            own_namespace(again, "/ev"),
        ):
            pass
    with own_namespace(2, "/ev"):
        assert reserved_domains() == []


def test_no_run_begins_where_no_node_finds_another(monkeypatch):
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "OFF")
    with (
        pytest.raises(RunFailed, match=r"^ROS_AUTOMATIC_DISCOVERY_RANGE=OFF is refused: "),
        free_domain(),
    ):
        pass


def test_a_domain_is_free_again_after_the_run():
    for _ in range(2):
        with free_domain() as again:
            assert again == 1


def test_when_all_are_taken_the_run_does_not_begin():
    with (
        free_domain(),
        free_domain(),
        free_domain(),
        pytest.raises(NoFreeDomain, match="1 to 3"),
        free_domain(),
    ):
        pass


@pytest.mark.parametrize("participant", [0, 1, 7])
def test_a_domain_in_which_anybody_lives_is_left_alone(participant, first_port):
    """Participant n listens 250 domain + 10 + 2 n above the first port (DDSI-RTPS 9.6.1.1)."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as stranger:
        stranger.bind(("127.0.0.1", first_port + 250 + 10 + 2 * participant))
        with free_domain() as free:
            assert free == 2


def test_the_lock_of_another_user_is_respected(tmp_path):
    """A domain with an unreadable lock file is not taken; a folder stands for such a file."""
    (tmp_path / "ev_stack_domain_1.lock").mkdir()
    with free_domain() as free:
        assert free == 2


def test_when_locks_of_others_block_all_domains_one_is_named(tmp_path):
    """A folder stands for what another user has put there."""
    for taken in range(1, 4):
        (tmp_path / f"ev_stack_domain_{taken}.lock").mkdir()
    with (
        pytest.raises(
            NoFreeDomain, match=rf"{tmp_path}/ev_stack_domain_1.lock belongs to user \d+ \(.+\)$"
        ),
        free_domain(),
    ):
        pass


def test_no_other_user_can_lock_our_lock_file(tmp_path):
    with free_domain() as free:
        assert (tmp_path / f"ev_stack_domain_{free}.lock").stat().st_mode & 0o077 == 0


def test_a_pipe_in_the_place_of_a_lock_delays_no_run(tmp_path):
    """Opening it to write would wait for a reader."""
    os.mkfifo(tmp_path / "ev_stack_domain_1.lock")
    with free_domain() as found:
        assert found == 2


def test_a_link_in_the_place_of_a_lock_is_not_followed(tmp_path):
    """The folder is everybody's: a link there could make us empty a file of the user's own."""
    precious = tmp_path / "precious"
    precious.write_text("kept")
    (tmp_path / "ev_stack_domain_1.lock").symlink_to(precious)
    with free_domain() as free:
        assert free == 2
    assert precious.read_text() == "kept"


@pytest.mark.parametrize("given", ["abc", "-1", "1.5", "500"])
def test_what_is_no_domain_is_refused(given, monkeypatch):
    monkeypatch.setenv("ROS_DOMAIN_ID", given)
    with (
        pytest.raises(
            RunFailed, match=f"^ROS_DOMAIN_ID={given} is refused, expected a whole number from 0"
        ),
        free_domain(),
    ):
        pass
