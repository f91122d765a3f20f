"""Pass CAN frames on between processes of this machine, where there is no multicast."""

from __future__ import annotations

import sys

from ev_bench.bus.socketcand_hub import HOST, SocketcandHub
from ev_nodes.stepping.stop_request import StopRequest, turn_deaf
from ev_stack.command_line.numbers import PORT
from ev_stack.command_line.refusal import Parser, refuse

_PATIENCE = 0.2  # s between looks whether it shall end


def main(argv: list[str] | None = None) -> None:
    """ros2 run ev_bench can_hub --port 29536"""
    parser = Parser(
        prog="can_hub", description=f"{__doc__} socketcand's raw mode over TCP on {HOST}."
    )
    parser.add_argument(
        "--port", type=PORT, default=29536, help="default 29536; 0 takes any free one"
    )
    given = parser.parse_args(argv)
    with StopRequest(patient=True) as stop:
        try:
            hub = SocketcandHub(
                given.port, lambda text: print(f"can_hub: {text}", file=sys.stderr, flush=True)
            )
        except OSError as error:
            refuse(f"can_hub: port {given.port}: {error.strerror}")
        print(f"can_hub: {HOST}:{hub.port}", flush=True)
        while not stop.received:
            hub.serve(_PATIENCE)
        hub.close()
        turn_deaf()


if __name__ == "__main__":
    main()
