"""Adapters over python-can: the same frames whatever carries them, and nothing that ends a node."""

from __future__ import annotations

import gc
import os
import resource
import select
import socket
import threading
import time
from collections.abc import Iterator
from contextlib import ExitStack, closing, contextmanager, suppress
from importlib.util import find_spec
from pathlib import Path
from types import SimpleNamespace

import can
import pytest
from fuzz.fuzzing import fuzzed
from helpers.patience import PATIENCE
from hypothesis import example, given
from hypothesis import strategies as st

from ev_bench.bus import channel as channel_module
from ev_bench.bus import socketcand_hub
from ev_bench.bus.channel import BusMeter, Channel, Channels, bus_log
from ev_bench.bus.opening import BusError, open_channel
from ev_bench.bus.parameters import DEFAULT_CHANNELS, INTERFACES, BusParameters
from ev_bench.bus.socketcand_hub import HOST, SocketcandHub
from ev_msgs_py.can.frame_length import Frame

FRAMES = [Frame(0x20B, bytes(range(8))), Frame(0x701, b"\x01\x02\x03\x04"), Frame(0x18B, b"")]


@contextmanager
def hub() -> Iterator[int]:
    """The port of a hub that serves in a thread."""
    running = SocketcandHub(0)
    stop = threading.Event()

    def serve() -> None:
        while not stop.is_set():
            running.serve(0.01)

    thread = threading.Thread(target=serve)
    thread.start()
    try:
        yield running.port
    finally:
        stop.set()
        thread.join()
        running.close()


def group(port: int) -> str:
    """A multicast channel that no other run of the tests uses."""
    return f"239.192.{os.getpid() % 250}.{port % 250}:{port}"


@contextmanager
def channel_name(interface: str) -> Iterator[str]:
    if interface == "socketcand":
        with hub() as port:
            yield f"can11@127.0.0.1:{port}"
    else:
        yield group(free_port()) if interface == "udp_multicast" else "test_channels"


def free_port() -> int:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as found:
        found.bind(("", 0))
        return found.getsockname()[1]


def can_multicast(sender: socket.socket) -> bool:
    """Return True if this machine receives its own multicast datagrams beside loopback."""
    sender.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 0)
    try:
        sender.sendto(b"", ("239.192.250.250", 9))
    except OSError:
        return False
    return True


def received(channel: Channel, count: int) -> list[Frame]:
    found, deadline = [], time.monotonic() + PATIENCE
    while len(found) < count and time.monotonic() < deadline:
        frame = channel.receive()
        if frame is not None:
            found.append(frame)
    return found


def test_a_reader_too_slow_for_its_bus_takes_what_is_new():
    """A slow reader drops frames older than a tenth of a second and names them."""
    with (
        channel_name("udp_multicast") as name,
        closing(Channel("udp_multicast", name)) as one,
        closing(Channel("udp_multicast", name)) as other,
    ):
        for _ in range(3):  # twice the first frame was taken at a load of 20; why is not known
            one.send(FRAMES[0])
            # its time is that at which it came
            assert select.select([other._bus], [], [], PATIENCE)[0]
            time.sleep(0.2)
            taken, deadline = None, time.monotonic() + PATIENCE
            # on a busy machine this one may be late, too
            while taken is None and time.monotonic() < deadline:
                one.send(FRAMES[1])
                taken = other.receive()
            if taken == FRAMES[1]:
                break
            while other.receive() is not None:
                pass
        assert taken == FRAMES[1]
        assert other.late >= 1
        assert other.trouble == f"{name}: frames that waited for more than 0.1 s were left out"


@pytest.mark.parametrize("interface", ["virtual", "udp_multicast", "socketcand"])
def test_frames_arrive_in_order_and_unchanged(interface: str):
    with channel_name(interface) as name:
        one, other = Channel(interface, name), Channel(interface, name)
        for frame in FRAMES:
            one.send(frame)
        assert received(other, len(FRAMES)) == FRAMES
        assert (one.sent, other.received, other.refused) == (3, 3, 0)
        one.close()
        other.close()


def test_two_multicast_channels_do_not_hear_each_other():
    """Sockets of one port hear all groups that anybody on the machine has joined.

    Each channel has its own port.
    """
    right, left = DEFAULT_CHANNELS["udp_multicast"]
    assert right.partition(":")[2] != left.partition(":")[2]
    names = [group(free_port()), group(free_port())]
    channels = [Channel("udp_multicast", name) for name in names]
    channels[0].send(FRAMES[0])
    # it hears itself, so that the frame has been there
    assert received(channels[0], 1) == FRAMES[:1]
    assert channels[1].receive() is None
    for channel in channels:
        channel.close()


def test_multicast_frames_stay_on_loopback():
    """Time to live is 0 (RFC 1112, section 6.1); frames are received there, of the group alone."""
    name = group(free_port())
    address, _, port = name.partition(":")
    with (
        closing(Channel("udp_multicast", name)) as channel,
        socket.socket(fileno=os.dup(channel._bus.fileno())) as same,
    ):
        assert same.getsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL) == 0
        assert same.getsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, 4) == socket.inet_aton(
            "127.0.0.1"
        )
        assert same.getsockname() == (address, int(port))
        channel.send(FRAMES[0])
        frame, _ = same.recvfrom(4096)
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as stranger:
            stranger.sendto(frame, ("127.0.0.1", int(port)))  # to this machine, not to the group
            if can_multicast(stranger):
                # to the group, on the network of this machine
                stranger.sendto(frame, (address, int(port)))
        channel.send(FRAMES[1])
        assert received(channel, 1) == FRAMES[1:2]
        assert channel.receive() is None


def test_the_hub_listens_on_this_machine_only():
    with hub() as port, socket.create_connection(("127.0.0.1", port)) as connection:
        assert connection.recv(100) == b"< hi >"
        connection.sendall(b"< nonsense >")
        assert b"error" in connection.recv(100)
    with hub() as port, pytest.raises(ConnectionRefusedError):
        socket.create_connection(("127.0.0.2", port), 0.5)  # as local, but another address


def test_an_address_of_another_machine_is_refused_in_one_line():
    with pytest.raises(BusError, match=r"channel 239.192.11.11:28111: \w[\w ]+$"):
        open_channel("udp_multicast", "239.192.11.11:28111", "192.0.2.77")


@pytest.mark.parametrize("step", [-3600.0, 3600.0])
def test_a_time_of_day_that_is_set_makes_no_frame_old(step: float, monkeypatch):
    """A frame is stamped by it when it comes.

    No frame has waited for longer than since nothing was waiting.
    """
    meter = BusMeter([FRAMES[0].identifier])
    with (
        channel_name("udp_multicast") as name,
        closing(Channel("udp_multicast", name)) as one,
        closing(Channel("udp_multicast", name, meter=meter)) as other,
    ):
        clock = SimpleNamespace(time=time.time, monotonic=lambda: 5.0)
        monkeypatch.setattr(channel_module, "time", clock)
        assert other.receive() is None
        one.send(FRAMES[0])
        assert select.select([other._bus], [], [], PATIENCE)[0]
        clock.time, clock.monotonic = lambda: time.time() + step, lambda: 5.001
        assert other.receive() == FRAMES[0]
        assert (other.late, other.trouble) == (0, "")
        assert meter.latency <= 0.0011


@contextmanager
def two_clients() -> Iterator[tuple[SocketcandHub, list[str], socket.socket, socket.socket]]:
    """A hub served by hand, its notes, and two clients of one bus."""
    notes: list[str] = []
    with (
        closing(SocketcandHub(0, notes.append)) as served,
        socket.create_connection((HOST, served.port)) as one,
        socket.create_connection((HOST, served.port)) as other,
    ):
        one.sendall(b"< open a >< rawmode >")
        other.sendall(b"< open a >< rawmode >")
        for client in (one, other):
            client.setblocking(False)
            while not text_of(client, served).endswith("< ok >< ok >"):
                pass
        for client in served.clients:
            client.settle()
        yield served, notes, one, other


def test_a_client_that_joins_a_busy_bus_has_the_answer_alone_and_then_all_frames(monkeypatch):
    """python-can takes for the answer whatever has come when it looks.

    The time in which frames are held back ends when the test has looked, however slow the machine
    is.
    """
    monkeypatch.setattr(socketcand_hub, "_SETTLES", 3600.0)
    with (
        two_clients() as (served, _, one, _),
        socket.create_connection((HOST, served.port)) as late,
    ):
        late.setblocking(False)
        for words, answer in (
            (b"< open a >", "< hi >< ok >"),
            (b"< rawmode >", "< hi >< ok >< ok >"),
        ):
            late.sendall(words)
            while len(text_of(late, served)) < len(answer):
                pass
            one.sendall(b"< send 123 0 >")
            assert text_of(late, served) == answer
        for client in served.clients:
            client.settle()
        while "frame 123" not in text_of(late, served):
            pass


def text_of(client: socket.socket, served: SocketcandHub) -> str:
    """Return the unread bytes of a client after the hub has done its work.

    "" if it was sent away.
    """
    for _ in range(20):
        served.serve(0.001)
    try:
        return client.recv(1 << 20, socket.MSG_PEEK).decode()
    except OSError:
        return ""


DIGITS = "0123456789abcdefABCDEF"
HEX = st.text(DIGITS, max_size=9)
LENGTHS = st.sampled_from(["0", "2", "8", "9", "-1", "02"])
ODD = st.sampled_from(
    ["-12", "+12", "0x1", "1_2", "７FF", "800", "2" * 8, "", "12", "20B", "0000020B"]
)


@fuzzed(30, 0.2)
@given(identifier=HEX | ODD, length=LENGTHS, data=st.lists(HEX | ODD, max_size=9))
@example("-12", "1", ["FF"])
@example("20B", "1", ["-1"])
@example("7FF", "2", ["0", "fF"])
def test_the_hub_passes_on_frames_and_sends_away_senders_of_anything_else(identifier, length, data):
    fits = len(identifier) in (3, 8) and length in ("0", "2", "8") and len(data) == int(length)
    fits = (
        fits
        and all(len(word) in (1, 2) for word in data)
        and set("".join([identifier, *data])) <= set(DIGITS)
    )
    fits = fits and int(identifier, 16) < (1 << 11 if len(identifier) == 3 else 1 << 29)
    with two_clients() as (served, notes, one, other):
        other.recv(1000)
        one.sendall(f"< send {identifier} {length} {' '.join(data)} >".encode())
        answer = text_of(other, served)
        assert bool(answer) is fits
        assert len(notes) is not fits
        if answer:
            _, _, shown, _, *shown_data, _ = answer.split()
            assert int(shown, 16) == int(identifier, 16)
            assert bytes.fromhex("".join(shown_data)) == bytes(int(word, 16) for word in data)


def test_a_hub_without_descriptors_lives_on_and_says_so_once():
    with two_clients() as (served, notes, one, other):
        limits = resource.getrlimit(resource.RLIMIT_NOFILE)
        waiting = [socket.socket() for _ in range(2)]
        resource.setrlimit(
            resource.RLIMIT_NOFILE, (max(map(int, os.listdir("/proc/self/fd"))), limits[1])
        )
        try:
            with suppress(OSError):
                while True:
                    waiting.append(socket.socket())  # whatever lower numbers are free
            for client in waiting[:2]:
                client.connect((HOST, served.port))
                client.setblocking(False)
                assert text_of(client, served) == ""
        finally:
            resource.setrlimit(resource.RLIMIT_NOFILE, limits)
            for client in waiting:
                client.close()
        assert notes == ["a client is sent away: Too many open files"]
        one.sendall(b"< send 123 0 >")
        assert "frame 123" in text_of(other, served)


def test_a_hub_has_no_more_clients_than_it_says():
    with two_clients() as (served, notes, one, other), ExitStack() as stack:
        for _ in range(31):
            last = stack.enter_context(socket.create_connection((HOST, served.port)))
            served.serve(0.01)
        last.setblocking(False)
        assert text_of(last, served) == ""
        assert notes == ["a client is sent away: there are 32, which is the most"]
        one.sendall(b"< send 123 0 >")
        assert "frame 123" in text_of(other, served)


@pytest.mark.parametrize("rubbish", [b">" * 65536, b"x" * 65536, b"< send 1 " * 7000])
def test_a_flood_without_sense_costs_the_hub_one_answer(rubbish, monkeypatch):
    with two_clients() as (served, notes, one, _):
        one.recv(1000)
        answers = []
        (client,) = (
            each
            for each in served.clients
            if each.transport.get_extra_info("peername") == one.getsockname()
        )
        write = client.transport.write
        monkeypatch.setattr(
            client.transport, "write", lambda answer: answers.append(answer) or write(answer)
        )
        one.sendall(rubbish)
        text_of(one, served)
        assert answers == [b"< error unknown command >"]
        assert len(notes) == 1 and len(notes[0]) < 300


def test_whatever_else_comes_is_counted_and_passed_over():
    channel, sender = (
        Channel("virtual", "test_others"),
        can.Bus(channel="test_others", interface="virtual"),
    )
    for special in (
        can.Message(arbitration_id=0x20B, is_extended_id=True, data=bytes(8)),
        can.Message(arbitration_id=0x20B, is_extended_id=False, is_remote_frame=True, dlc=8),
        can.Message(is_error_frame=True),
        can.Message(arbitration_id=0x20B, is_extended_id=False, is_fd=True, data=bytes(12)),
    ):
        sender.send(special)
    sender.send(can.Message(arbitration_id=0x20B, is_extended_id=False, data=bytes(8)))
    assert channel.receive() == Frame(0x20B, bytes(8))
    assert channel.refused == 4
    channel.close()
    sender.shutdown()


def test_datagrams_that_are_no_frames_do_no_harm():
    """Rubbish on the multicast port, among it what msgpack chokes on."""
    name = group(free_port())
    channel = Channel("udp_multicast", name)
    address, _, port = name.partition(":")
    rubbish = [
        b"",
        b"\xc1",
        b"\x81",
        b"\xdf\xff\xff\xff\xff",
        b"\x80",
        b"\x81\xa1a",
        os.urandom(3000),
        b"\x01\x02",
    ]
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as stranger:
        stranger.setsockopt(
            socket.IPPROTO_IP, socket.IP_MULTICAST_IF, socket.inet_aton("127.0.0.1")
        )
        for datagram in rubbish:
            stranger.sendto(datagram, (address, int(port)))
    channel.send(FRAMES[0])
    assert received(channel, 1) == FRAMES[:1]
    assert channel.refused == len(rubbish)
    assert "not read" in channel.trouble
    channel.close()


@pytest.mark.parametrize(
    ("interface", "channel", "message"),
    [
        # no such device, or no CAN in this kernel
        ("socketcan", "can77", "CAN interface socketcan, channel can77: "),
        ("socketcand", "can11@127.0.0.1:1", "channel can11@127.0.0.1:1: Connection refused"),
        (
            "socketcand",
            "can11@192.0.2.7:1",
            "host '192.0.2.7' is refused, expected 127.0.0.1 unless bus.address is",
        ),
        ("socketcand", "can11", "channel can11: is not of the form NAME@HOST:PORT"),
        (
            "udp_multicast",
            "10.0.0.1:28111",
            "channel 10.0.0.1:28111: 10.0.0.1 is no multicast address",
        ),
        ("udp_multicast", "239.192.11.11", "is not of the form GROUP:PORT"),
        ("udp_multicast", "239.192.11.11:99999", "port '99999' is refused, expected 1 to 65535"),
        ("udp_multicast", "bus:28111", "Expected 4 octets in 'bus'"),
    ],
)
def test_a_channel_that_cannot_be_had_is_one_clear_line(interface: str, channel: str, message: str):
    with pytest.raises(BusError) as refused:
        open_channel(interface, channel)
    assert message in str(refused.value)
    assert "\n" not in str(refused.value)


def test_a_port_in_use_is_the_only_line(caplog):
    """python-can would warn behind it in the same line that the bus was not shut down."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other:
        other.bind(("", 0))
        with pytest.raises(BusError, match="Address already in use"):
            open_channel("udp_multicast", f"239.192.11.11:{other.getsockname()[1]}")
    gc.collect()
    assert caplog.messages == []


def test_every_interface_has_a_channel_for_each_circuit():
    for interface in INTERFACES:
        assert len(set(BusParameters(interface=interface).channels().values())) == 2
    assert BusParameters(interface="socketcan", channel_11="can5").channels() == {
        "11": "can5",
        "12": "can1",
    }


@pytest.mark.parametrize("suffix", [".log", ".blf"])
@pytest.mark.parametrize("interface", ["virtual", "udp_multicast"])
def test_a_log_holds_what_was_sent_and_received_once(tmp_path: Path, suffix: str, interface: str):
    file = tmp_path / f"bus{suffix}"
    with channel_name(interface) as name:
        log = bus_log(str(file))
        channel, other = Channel(interface, name, log), Channel(interface, name)
        channel.send(FRAMES[0])
        other.send(FRAMES[1])
        received(channel, 2 if interface == "udp_multicast" else 1)
        log.stop()
        channel.close()
        other.close()
    read = [(message.arbitration_id, bytes(message.data)) for message in can.LogReader(file)]
    assert read == [tuple(frame) for frame in FRAMES[:2]]


def test_logs_that_cannot_be_written_are_refused(tmp_path: Path):
    with pytest.raises(
        ValueError, match=r"'bus.txt' is refused, expected files ending with .log, .blf, .mf4"
    ):
        bus_log("bus.txt")
    with pytest.raises(ValueError, match="No such file or directory"):
        bus_log(str(tmp_path / "none" / "bus.log"))
    (tmp_path / "victim.log").write_text("precious")
    (tmp_path / "link.log").symlink_to(tmp_path / "none.log")
    for name in ("victim.log", "link.log"):
        with pytest.raises(ValueError, match=r"is refused, expected a file that is not there yet"):
            bus_log(str(tmp_path / name))
    assert (tmp_path / "victim.log").read_text() == "precious"


@pytest.mark.parametrize("suffix", [".log", ".blf"])
def test_no_log_is_left_of_a_bus_that_cannot_be_had(tmp_path: Path, suffix: str):
    """It would be refused as one that is there at the next try; a file of the user's stays."""
    file = tmp_path / f"bus{suffix}"
    nowhere = BusParameters(interface="socketcand", channel_11="can1", channel_12="can2")
    for _ in range(2):
        with pytest.raises(BusError, match="is not of the form"):
            Channels(nowhere, str(file))
        assert not file.exists()
    file.write_text("precious")
    with pytest.raises(ValueError, match="expected a file that is not there yet"):
        Channels(nowhere, str(file))
    assert file.read_text() == "precious"


def test_mf4_says_what_it_needs(tmp_path: Path):
    if find_spec("asammdf"):
        bus_log(str(tmp_path / "bus.mf4")).stop()
        return
    with pytest.raises(ValueError, match="needs the Python package asammdf, which is missing"):
        bus_log(str(tmp_path / "bus.mf4"))


def test_a_client_that_takes_nothing_delays_no_other():
    """10 000 frames are far more than a socket keeps for a client; the others get all of them."""
    with hub() as port:
        idle, sender, taker = (Channel("socketcand", f"a@127.0.0.1:{port}") for _ in range(3))
        taken = 0
        for _ in range(100):
            for _ in range(100):
                sender.send(FRAMES[0])
            taken += len(received(taker, 100))
        assert taken == 10_000
        assert received(idle, 1) == FRAMES[:1]
        for channel in (idle, sender, taker):
            channel.close()
