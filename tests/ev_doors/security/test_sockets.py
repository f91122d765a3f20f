"""Whatever is started listens on this machine alone.

All sockets of all its processes, and a stranger tries them.
"""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import time
import uuid
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from xml.etree import ElementTree

import can
import pytest
from can.interfaces.udp_multicast.utils import pack_message
from helpers.namespaces import HERE, Network, NoNamespaces
from helpers.patience import wait_until
from helpers.run_script import ENVIRONMENT, ROOT, RUN
from helpers.sockets_of_process import Socket, sockets_of

from ev_stack.running.domain import free_domain

pytestmark = pytest.mark.slow

OF_SETUP = (
    "FASTDDS_DEFAULT_PROFILES_FILE",
    "FASTRTPS_DEFAULT_PROFILES_FILE",
    "ROS_AUTOMATIC_DISCOVERY_RANGE",
)
DDS = "{http://www.eprosima.com}"
MARK = "EV_STACK_TEST_SOCKETS"  # in the environment of all processes that belong to one try
SHORT = f"{RUN} shchur2019 --duration 0.5 --no-report --out OUT"
HUB = f"{sys.executable} -m ev_bench.can_hub --port 0"
BENCH = (
    f"{RUN} bench_fault --realtime --duration 1000 --no-report --no-record --out OUT --set *.control_period=0.005"
    + "".join(
        f" --set {each}"
        for each in (
            "test_bench.command_timeout=1",
            "test_bench.load.command_timeout=1",
            "inverter_gateway.feedback_timeout=1",
            "inverter_gateway.command_timeout=10",
            "inverter_gateway.bus.log=bus.log",
        )
    )
)
STUDY = f"{RUN} sweep coast_down --vary plant.initial_speed=5:10:5 --out OUT"
LOCAL = "--host 127.0.0.1 --dashboard-address 127.0.0.1:0"  # docs/security.md
DASK = f"""
{sys.executable} -m distributed.cli.dask_scheduler {LOCAL} --port PORT & scheduler=$!
{sys.executable} -m distributed.cli.dask_worker tcp://127.0.0.1:PORT {LOCAL} & worker=$!
{STUDY} --scheduler tcp://127.0.0.1:PORT; status=$?
kill $worker $scheduler; wait; exit $status
"""
STRANGERS = pack_message(can.Message(arbitration_id=0x123, is_extended_id=False))
INSIDER = """
import time
from ev_bench.bus.channel import Channel
from ev_msgs_py.can.frame_length import Frame
channel = Channel("udp_multicast", "{0.address}:{0.port}")
while True:
    channel.send(Frame(0x124, b""))
    time.sleep(0.05)
"""
# By way of running: the words of a shell, and how many sockets it has at least
WAYS = {
    "processes": (SHORT, 10),
    "one process": (f"{SHORT} --in-process", 3),
    "offline": (f"{SHORT} --offline", 0),
    "bus in real time": (BENCH, 12),
    "hub": (HUB, 1),
    "live page": (
        f"{ROOT}/scripts/dashboard.sh --port 0 shchur2019 --duration 0.5 --no-report --no-record --out OUT",
        11,
    ),
    "workers": (f"{STUDY} --workers 2", 0),
    "dask": (DASK, 3),
}
# the live page is processes and a page, the hub is a bus
SHOWN_BY_OTHERS = ("processes", "bus in real time", "dask")


@pytest.fixture(scope="module")
def network() -> Iterator[Network | NoNamespaces]:
    try:
        made = Network()
    except NoNamespaces as reason:
        yield reason
        return
    yield made
    made.close()


def free_port() -> int:
    with socket.create_server(("127.0.0.1", 0)) as found:
        return found.getsockname()[1]


class Try:
    """A process under way, in the namespace if there is one, and all sockets seen of it."""

    def __init__(self, words: str, network: Network | NoNamespaces, folder: Path) -> None:
        self._mark = uuid.uuid4().hex
        self.output = (folder / "output.txt").open("w+")
        self.process = subprocess.Popen(
            [
                *(network.inside if isinstance(network, Network) else ()),
                "bash",
                "-c",
                words.replace("OUT", str(folder / "out")),
            ],
            env={**ENVIRONMENT, MARK: self._mark},
            stdout=self.output,
            stderr=subprocess.STDOUT,
            start_new_session=True,
        )
        self.seen: set[Socket] = set()

    def look(self) -> set[Socket]:
        """The sockets that were not seen before."""
        found: set[Socket] = set()
        for folder in Path("/proc").glob("[0-9]*"):
            with suppress(OSError):  # it has ended, or is of another user
                if f"{MARK}={self._mark}".encode() in (folder / "environ").read_bytes():
                    found.update(sockets_of(folder.name))
        new = found - self.seen
        self.seen |= new
        return new

    def text(self) -> str:
        self.output.seek(0)
        return self.output.read()

    def end(self) -> None:
        """Nothing of it is left."""
        with suppress(ProcessLookupError):
            os.killpg(self.process.pid, signal.SIGKILL)
        self.process.wait()
        self.output.close()


@pytest.mark.parametrize(
    "way",
    [
        pytest.param(way, marks=pytest.mark.weekly) if way in SHOWN_BY_OTHERS else way
        for way in WAYS
    ],
)
def test_every_socket_is_bound_to_loopback_and_a_stranger_is_refused(way, network, tmp_path):
    """A multicast group is received on loopback alone: the bus logs no stranger's frame.

    The run ends when it has logged the insider's, sent behind the stranger's.
    """
    words, least = WAYS[way]
    under_way = Try(words.replace("PORT", str(free_port())), network, tmp_path)
    not_refused, groups, insiders, log = [], set(), {}, tmp_path / "out" / "bus.log"

    def is_enough() -> bool:
        """Return True once a command that goes on by itself can be stopped."""
        if words == BENCH and isinstance(network, Network):
            return log.exists() and " 124#" in log.read_text()
        return words in (HUB, BENCH) and len(under_way.seen) >= least

    is_stopped = False
    try:
        while under_way.process.poll() is None:
            new = under_way.look()
            if isinstance(network, Network):
                not_refused += network.not_refused(new)
                groups |= network.groups()
                for each in under_way.seen:
                    if each.address.is_multicast:
                        network.ask(str(each.address), each.port, STRANGERS.hex())
                        if each not in insiders:
                            code = [sys.executable, "-c", INSIDER.format(each)]
                            insiders[each] = subprocess.Popen([*network.inside, *code])
            if not is_stopped and is_enough():  # once: it stops at the first signal
                is_stopped = True
                under_way.process.send_signal(signal.SIGINT)
            time.sleep(0.2)
        assert under_way.process.returncode == (130 if words == BENCH else 0), under_way.text()
    finally:
        under_way.end()
        for insider in insiders.values():
            insider.kill()
            insider.wait()
    assert len(under_way.seen) >= least, under_way.seen
    assert [
        each
        for each in under_way.seen
        if not (each.address.is_loopback or each.address.is_multicast)
    ] == []
    assert (not_refused, groups) == ([], set())
    if isinstance(network, Network) and words == BENCH:
        logged = {message.arbitration_id for message in can.LogReader(tmp_path / "out" / "bus.log")}
        assert logged & {0x123, 0x124} == {0x124}


@pytest.mark.parametrize("node", ["ev_sim/plant", "ev_control/asr"])
def test_a_node_that_a_shell_starts_by_hand_listens_on_this_machine_alone(node, tmp_path):
    """Settings of scripts/setup.sh hold under every ROS 2.

    An unread profile opens all addresses.
    """
    bare = {name: value for name, value in os.environ.items() if name not in OF_SETUP}
    package, name = node.split("/")
    shell = f"source {ROOT}/scripts/setup.sh && exec {ROOT}/install/{package}/lib/{package}/{name}"
    with free_domain() as domain, (tmp_path / "output.txt").open("w+") as output:
        process = subprocess.Popen(
            ["bash", "-c", shell],
            env=bare | {"ROS_DOMAIN_ID": str(domain)},
            stdout=output,
            stderr=subprocess.STDOUT,
        )
        try:
            wait_until(
                lambda: "ready" in Path(output.name).read_text() or process.poll() is not None
            )
            assert process.poll() is None, Path(output.name).read_text()
            sockets = sockets_of(process.pid)
        finally:
            process.kill()
            process.wait()
    assert len(sockets) >= 3
    assert [each for each in sockets if not each.address.is_loopback] == []


OF_FAST_DDS_2 = {
    "nack_supression_duration": "nackSupressionDuration",
    "heartbeat_response_delay": "heartbeatResponseDelay",
}


def setting_of(element: ElementTree.Element) -> tuple[str, str]:
    name = element.tag.removeprefix(DDS)
    return OF_FAST_DDS_2.get(name, name), (element.text or "").strip()


def test_both_profiles_say_the_same():
    """Fast DDS 3 and Fast DDS 2 have words of their own.

    The older one asks for no layout of types.
    """
    newer, older = (
        ElementTree.parse(ROOT / "config" / name).getroot()
        for name in ("fastdds.xml", "fastdds2.xml")
    )
    rtps = newer.find(f"{DDS}participant/{DDS}rtps")
    rtps.remove(rtps.find(f"{DDS}propertiesPolicy"))
    assert [setting_of(each) for each in newer.iter()] == [
        setting_of(each) for each in older.iter()
    ]


LISTENER = f"""
import socket, sys
from ev_bench.bus.channel import Channel
names = ("239.192.11.0:28111", "239.192.11.1:28112")
channels = [Channel("udp_multicast", n, address=a) for n, a in zip(names, ("127.0.0.1", "{HERE}"))]
open_tcp, open_udp = socket.create_server(("", 28001)), socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
open_udp.bind(("", 28002))
print("listens", flush=True)
sys.stdin.readline()
print([channel.receive() is not None for channel in channels], flush=True)
"""


def test_a_stranger_finds_what_is_open_and_is_heard_where_the_user_says_so(network):
    """Sockets at all addresses are found.

    `bus.address` puts the bus on the network of that address.
    """
    if isinstance(network, NoNamespaces):
        pytest.skip(f"a stranger on another machine was not tried: {network}")
    words = [*network.inside, sys.executable, "-c", LISTENER]
    with subprocess.Popen(
        words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as listener:
        assert listener.stdout.readline() == "listens\n"
        assert network.ask(HERE, [28001, 28003], [28002, 28004, 28111, 28112]) == [
            "tcp 28001",
            "udp 28002",
        ]
        assert network.groups() == {"239.192.11.1"}
        for n in range(2):
            network.ask(f"239.192.11.{n}", 28111 + n, STRANGERS.hex())
        assert listener.communicate("\n")[0] == "[False, True]\n"
