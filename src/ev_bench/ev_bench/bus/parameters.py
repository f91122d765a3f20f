"""The parameters of a node's bus, and the DBC file of its frames, read once when a node starts."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType

from ev_core.parameters.data_file import TEXT, TextOfFile, find_file, read_data
from ev_core.parameters.declaration import setting
from ev_msgs_py.can.database import Database, database_of
from ev_msgs_py.refusal import ParameterError, quoted

EV_BENCH = "can/ev_bench.dbc"
INTERFACES = ("virtual", "udp_multicast", "socketcand", "socketcan")
CIRCUITS = ("11", "12")  # right and left
LOOPBACK = "127.0.0.1"  # from where no frame leaves this machine
# Channels where none is named: right and left circuit.
DEFAULT_CHANNELS = MappingProxyType(
    {
        "virtual": ("ev_bench_11", "ev_bench_12"),
        "udp_multicast": ("239.192.11.11:28111", "239.192.11.12:28112"),
        "socketcand": ("can11@127.0.0.1:29536", "can12@127.0.0.1:29536"),
        "socketcan": ("can0", "can1"),
    }
)


def load_database(name: str = EV_BENCH) -> Database:
    """The database in a DBC file; a relative name counts from the config folder.

    ParameterError in one line that names the file if it cannot be read, or if `database_of` refuses
    it.
    """
    path: Path | str = name
    try:
        path = find_file(name)
        return database_of(read_data(path, TEXT))
    except OSError as error:
        raise ParameterError(f"CAN database {path}: {error.strerror or error}") from None
    except ParameterError as error:
        raise ParameterError(f"CAN database {path}: {error}") from None


@dataclass(frozen=True, slots=True)
class BusInterface:
    """Frames of the bus, and their carrier in real time: one channel for each circuit."""

    interface: str = setting(
        "udp_multicast",
        choices=INTERFACES,
        about=(
            "virtual: within one process; udp_multicast: between processes, see `bus.address`;"
            " socketcand: between those of this machine, over TCP through `ev_bench can_hub`;"
            " socketcan: hardware"
        ),
        read_only=True,
    )
    channel_11: str = setting(
        "",
        about=(
            "of the right circuit: a name, GROUP:PORT, NAME@HOST:PORT or a network interface, by"
            " the interface; empty for its usual one"
        ),
        read_only=True,
    )
    channel_12: str = setting("", about="of the left circuit, likewise", read_only=True)
    address: str = setting(
        LOOPBACK,
        about=(
            "of this machine in the network that udp_multicast uses; with any but 127.0.0.1 all"
            " machines there receive all frames and can send some"
        ),
        read_only=True,
    )
    database: str = setting("can/ev_bench.dbc", about="DBC file of the frames", read_only=True)

    def __post_init__(self) -> None:
        """Refuse what a file may not open: sockets on a network, and addresses beyond its reach."""
        if isinstance(self.address, TextOfFile) and self.address != LOOPBACK:
            raise ParameterError(
                f"address: {quoted(str(self.address))} is refused, expected from a file {LOOPBACK};"
                " another network is named on the command line: --set NODE.bus.address=ADDRESS,"
                " for a node -p bus.address:=ADDRESS"
            )
        # The text of a file may name a database only where `find_file` lets it.
        if isinstance(self.database, TextOfFile):
            try:
                find_file(self.database)
            except ParameterError as error:
                raise ParameterError(f"database: {error}") from None

    def channels(self) -> dict[str, str]:
        """The channel of each circuit."""
        usual = DEFAULT_CHANNELS[self.interface]
        named = (self.channel_11, self.channel_12)
        return {circuit: named[place] or usual[place] for place, circuit in enumerate(CIRCUITS)}


@dataclass(frozen=True, slots=True)
class BusParameters(BusInterface):
    """The CAN bus of a node and its log."""

    log: str = setting(
        "",
        about=(
            "file for all frames that are sent and received: .log (candump), .blf (Vector) or,"
            " where asammdf is installed, .mf4; empty for none; that of a run lies beside its"
            " signals"
        ),
        read_only=True,
    )
