"""How soon the plant gives no torque any more when commands stop, and whether it gives torque when they come back.

    source scripts/setup.sh && python benchmarks/command_timeout.py [--trials N] [--seed N]

A plant in real time, and in another thread somebody who commands 50 N m, stops at a random moment,
and goes on later. Measured by the monotonic clock at the plant's own topic, `wheel_states`: from
the last command that was sent to the first state that shows no torque, and from the first command
after that to the first state that shows some.
"""

from __future__ import annotations

import argparse
import random
import threading
import time

import rclpy
from rclpy.context import Context
from rclpy.node import Node
from rclpy.parameter import Parameter

from ev_msgs_py.contract.frame import PLACES, Frame, numbers_of
from ev_msgs_py.contract.signals import SteeringColumnState, WheelStates, WheelTorqueCommand
from ev_msgs_py.contract.topics import TOPICS
from ev_msgs_py.wire import format_of
from ev_nodes.run_role import make_node
from ev_nodes.stepping.signal_io import QUALITY
from ev_nodes.stepping.spinning import spin
from ev_stack.running.domain import free_domain

TIMEOUT, PERIOD = 0.1, 0.01  # s, the defaults
_LONG = 10.0  # s that nothing here may take


class Commander:
    """Everything around the plant: nodes with the names of the asr and the column, and an ear for the wheels."""

    def __init__(self, context: Context) -> None:
        self._asr, column = (
            Node(name, context=context, namespace="/ev") for name in ("asr", "steering_column")
        )
        self._command, self._column = (
            node.create_publisher(
                format_of(signal).message_class, TOPICS[signal].name, QUALITY
            ).handle
            for node, signal in ((self._asr, WheelTorqueCommand), (column, SteeringColumnState))
        )
        wheels = format_of(WheelStates)
        self._read, self._kind = wheels.read, wheels.message_class
        self._ear = self._asr.create_subscription(
            self._kind, "wheel_states", lambda _: None, QUALITY, raw=True
        ).handle
        self._column_node = column
        self._efforts = [
            TOPICS[WheelStates].shape.channels.index(f"effort.front_{side}")
            for side in ("left", "right")
        ]
        self._stamp = 0
        self._frame = Frame()
        place = PLACES[WheelTorqueCommand]
        self._frame.numbers[place] = numbers_of(
            [50.0, 50.0, *[0.0] * (place.stop - place.start - 2)]
        )

    def hear(self) -> bool | None:
        """Whether the wheels of the next state are driven; None if there is none yet."""
        taken = self._ear.take_message(self._kind, True)
        if taken is None:
            return None
        self._stamp, numbers = self._read(taken[0])
        return any(numbers[i] != 0.0 for i in self._efforts)

    def wait_for(self, driven: bool, command: bool) -> float:
        """Wall time at which a state with or without torque comes; meanwhile every state is answered, or none."""
        deadline = time.monotonic() + _LONG
        while time.monotonic() < deadline:
            heard = self.hear()
            if heard is driven:
                return time.monotonic()
            if command and heard is not None:
                self.command()
            time.sleep(0.0002)
        raise RuntimeError(f"no state {'with' if driven else 'without'} torque within {_LONG:g} s")

    def command(self) -> float:
        """Answer the last state; the wall time."""
        self._command.publish_raw(format_of(WheelTorqueCommand).pack(self._stamp, self._frame))
        return time.monotonic()

    def begin(self) -> None:
        """Let the plant begin: it waits for both."""
        while self.hear() is None or not self._stamp:
            self._column.publish_raw(format_of(SteeringColumnState).pack(0, Frame()))
            self._command.publish_raw(format_of(WheelTorqueCommand).pack(0, Frame()))
            time.sleep(0.01)

    def trial(self, chance: random.Random) -> tuple[float, float]:
        """Seconds to no torque after the last command, and to torque after the first."""
        first = self.command()
        back = self.wait_for(driven=True, command=True) - first
        end = time.monotonic() + chance.uniform(0.02, 0.08)
        last = first
        while time.monotonic() < end:
            if self.hear() is not None:
                last = self.command()
            time.sleep(0.0002)
        gone = self.wait_for(driven=False, command=False) - last
        pause = time.monotonic() + chance.uniform(0.0, 0.05)
        while time.monotonic() < pause:
            self.hear()
            time.sleep(0.0002)
        return gone, back


def trials(number: int, seed: int) -> list[tuple[float, float]]:
    """What each trial has given."""
    chance, found = random.Random(seed), []
    with free_domain() as domain:
        context = Context()
        rclpy.init(context=context, domain_id=domain)
        values = {
            "mode": "realtime",
            "method": "kinematic",
            "command_timeout": TIMEOUT,
            "control_period": PERIOD,
        }
        overrides = [Parameter(name, value=value) for name, value in values.items()]
        plant = make_node("plant", context=context, namespace="/ev", parameter_overrides=overrides)
        commander, over = Commander(context), threading.Event()
        thread = threading.Thread(target=spin, args=([plant], over.is_set))
        thread.start()
        try:
            commander.begin()
            for _ in range(number):
                found.append(commander.trial(chance))
        finally:
            over.set()
            thread.join()
            context.try_shutdown()
    return found


def main() -> None:
    """Print how many trials kept the limits, and the longest times."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--trials", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    found = trials(given.trials, given.seed)
    gone, back = ([times[i] for times in found] for i in (0, 1))
    limit = TIMEOUT + PERIOD
    print(
        f"no torque within {limit:g} s of the last command: {sum(t <= limit for t in gone)} of"
        f" {len(gone)} trials, ",
        end="",
    )
    print(f"{1e3 * min(gone):.1f} to {1e3 * max(gone):.1f} ms")
    print(f"torque again after the first command: {len(back)} of {given.trials} trials, ", end="")
    print(f"{1e3 * min(back):.1f} to {1e3 * max(back):.1f} ms")


if __name__ == "__main__":
    main()
