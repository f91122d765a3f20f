"""Any text in a field of the page or on its socket gets one line, and the connection lives."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Iterator
from typing import Any

import pytest
from fuzz.fuzzing import fuzzed
from helpers.patience import PATIENCE
from helpers.ros_graph import NAMESPACE, node_of, ros_domain
from hypothesis import example, given
from hypothesis import strategies as st
from rclpy.executors import SingleThreadedExecutor
from tornado.httpclient import HTTPClientError, HTTPRequest
from tornado.websocket import websocket_connect

from ev_doors.dashboard.controls import Controls
from ev_doors.dashboard.server import Pages, listening

NODE = "asr"  # with numbers, whole numbers, a flag, a choice and arrays
FIELDS = ("seed", "vehicle.mass", "lock_memory", "method", "faults")
NESTED = "[" * 100_000


class Page:
    """A node with parameters, the server beside it, and a client of its socket, in one thread."""

    def __init__(self, context: Any) -> None:
        self.loop = asyncio.new_event_loop()
        self.node = node_of(context, NODE, {})
        self.spinner = SingleThreadedExecutor(context=context)
        self.spinner.add_node(self.node)
        self.loop.run_until_complete(self._open(context))

    async def _open(self, context: Any) -> None:
        self.controls = Controls(
            context, NAMESPACE, "requests", lambda message: self.pages.tell(message)
        )
        self.pages = Pages("requests", listening(0), self.controls.obey, list)
        self.address = self.pages.url.replace("http", "ws")
        self.socket = await websocket_connect(f"{self.address}live")
        while NODE not in self.controls.nodes:
            await self._turn()
        self.names = {each["name"] for each in self.controls.nodes[NODE]["parameters"]}

    async def _turn(self) -> None:
        self.spinner.spin_once(timeout_sec=0.0)
        self.controls.look()
        await asyncio.sleep(0.0)

    def answer(self, text: str | bytes) -> dict[str, Any]:
        """The line that comes back for a message."""
        return self.loop.run_until_complete(asyncio.wait_for(self._answer(text), PATIENCE))

    async def _answer(self, text: str | bytes) -> dict[str, Any]:
        await self.socket.write_message(text, binary=isinstance(text, bytes))
        coming = asyncio.ensure_future(self.socket.read_message())
        while True:
            while not coming.done():
                await self._turn()
            reply = coming.result()
            assert reply is not None, f"the connection has ended by {text[:200]!r}"
            message = json.loads(reply)
            if message["kind"] == "word":
                return message
            coming = asyncio.ensure_future(self.socket.read_message())

    def set(self, name: str, value: Any) -> dict[str, Any]:
        """The line for a value of a parameter."""
        return self.answer(json.dumps({"kind": "set", "node": NODE, "name": name, "value": value}))

    def status(self, **headers: str) -> int:
        """HTTP status for the socket of a browser with these headers: 101 if it is connected."""
        return self.loop.run_until_complete(self._status(headers))

    async def _status(self, headers: dict[str, str]) -> int:
        try:
            (await websocket_connect(HTTPRequest(f"{self.address}live", headers=headers))).close()
        except HTTPClientError as refused:
            return refused.code
        return 101


@pytest.fixture(scope="module")
def page() -> Iterator[Page]:
    with ros_domain() as context:
        page = Page(context)
        yield page
        page.pages.close()
        page.node.destroy_node()
        page.loop.run_until_complete(asyncio.sleep(0.0))
        page.loop.close()


def is_one_line(reply: dict[str, Any]) -> bool:
    return (
        bool(reply["text"])
        and reply["text"].splitlines() == [reply["text"]]
        and len(reply["text"]) < 500
    )


@fuzzed(40, 0.2)
@given(
    name=st.sampled_from(FIELDS),
    value=st.text() | st.text("[]{}@:,'\"-.0123456789eE!&*|> \n", max_size=12),
)
@example("seed", "1e30")
@example("seed", "99999999999999999999")
@example("seed", "2.5")
@example("seed", "true")
@example("lock_memory", "much")
@example("vehicle.mass", "[1")
@example("vehicle.mass", "{")
@example("vehicle.mass", "@")
@example("vehicle.mass", "a: b: c")
@example("vehicle.mass", "9" * 400)
@example("vehicle.mass", "[" * 1000)
@example("vehicle.mass", "x" * 200_000)
@example("faults", "[1, a]")
@example("faults", "[99999999999999999999]")
@example("faults", "[[1]]")
@example("method", "\ud800")
@example("method", "a\0b")
def test_whatever_stands_in_a_field_is_answered_by_one_line(page, name, value):
    reply = page.set(name, value)
    assert is_one_line(reply)
    assert reply["refused"] or name == "faults", reply  # the other ones are fixed at start


json_values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5),
    lambda of: (
        st.lists(of, max_size=3)
        | st.dictionaries(st.sampled_from(["kind", "node", "name", "value"]), of)
    ),
    max_leaves=5,
)


@fuzzed(40, 0.2)
@given(st.text() | st.binary() | json_values.map(json.dumps))
@example(NESTED)
@example(f'{{"kind": "set", "node": "{NODE}", "name": "faults", "value": {"[" * 400}{"]" * 400}}}')
@example('{"kind": "time", "service": []}')
@example("9" * 5000)
def test_whatever_comes_over_the_socket_is_answered_by_one_line(page, text):
    if isinstance(text, str):
        text = text.encode("utf-8", "replace").decode()  # a socket carries no others
    reply = page.answer(text)
    assert is_one_line(reply)
    assert reply["refused"]


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("faults", "[]", f"{NODE}.faults = []"),
        ("faults", "[offset torque_command 1]", f"{NODE}.faults = ['offset torque_command 1']"),
        (
            "faults",
            "none",
            f"{NODE}.faults: 'none' is refused, expected an array in brackets, [] for an empty one",
        ),
        ("seed", "1e30", f"{NODE}.seed: '1e30' is refused, expected integer"),
        ("vehicle.mass", "a: b: c", f"{NODE}.vehicle.mass: 'a: b: c' is refused, expected double"),
    ],
)
def test_what_the_line_says(page, name, value, message):
    assert page.set(name, value)["text"] == message


def test_pages_of_other_sites_have_no_socket(page):
    """Neither another site in the browser nor one with a name for this machine has one."""
    own = f"127.0.0.1:{page.pages.port}"
    assert page.status(Origin=f"http://{own}") == 101
    for origin in (
        "http://elsewhere.example",
        "http://127.0.0.1",
        f"http://{own}.elsewhere.example",
        "null",
    ):
        assert page.status(Origin=origin) == 403, origin
    rebound = f"elsewhere.example:{page.pages.port}"
    assert page.status(Origin=f"http://{rebound}", Host=rebound) == 403
