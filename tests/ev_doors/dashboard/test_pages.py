"""Pages that go in the middle of a message, as browsers do: nothing of that reaches the run."""

from __future__ import annotations

import asyncio
import random
import socket
import struct

from ev_doors.dashboard.server import ADDRESS, Pages, listening

PAGES = 200
ROW = bytes(8 * 4000)  # more than what a socket takes at once, so that messages are cut in two
WORD = {"kind": "word", "text": "x" * 50_000, "refused": False}
HANDSHAKE = (
    "GET /live HTTP/1.1\r\nHost: {host}\r\nOrigin: http://{host}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
    "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n\r\n"
)
ENDS = ("reset", "half a request", "goodbye", "goodbye and no more reading")


async def _leave(pages: Pages, how: str, chance: random.Random) -> None:
    """A page that connects, reads a little, and goes."""
    reader, writer = await asyncio.open_connection(ADDRESS, pages.port)
    writer.write(HANDSHAKE.format(host=f"{ADDRESS}:{pages.port}").encode())
    await reader.readuntil(b"\r\n\r\n")
    await reader.readexactly(chance.randrange(1, 3000))
    raw = writer.get_extra_info("socket")
    if how == "reset":
        raw.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
    elif how == "half a request":
        writer.write(b"\x81\xfe\x01\x00")
    # the closing handshake: the server answers, and is about to close while it has more to send
    else:
        writer.write(b"\x88\x80\x00\x00\x00\x00")
    if how.startswith("goodbye"):
        await asyncio.sleep(0)
        pages.add(ROW)
        await asyncio.sleep(0.001 * chance.random())
    writer.transport.abort() if how.endswith("reading") else writer.close()


def test_a_page_that_goes_in_the_middle_of_a_message_ends_nothing():
    failures: list[dict] = []

    async def run() -> None:
        asyncio.get_running_loop().set_exception_handler(
            lambda _, context: failures.append(context)
        )
        pages = Pages("a test", listening(0), lambda request: None, lambda: [WORD])
        chance, over = random.Random(1), asyncio.Event()

        async def speak() -> None:
            while not over.is_set():
                pages.add(ROW)
                pages.tell(WORD)
                await asyncio.sleep(0.002)

        speaking = asyncio.create_task(speak())
        for n in range(PAGES):
            await _leave(pages, ENDS[n % len(ENDS)], chance)
        over.set()
        await speaking
        while pages.open:  # the time limit of a test ends it
            await asyncio.sleep(0.01)
        pages.close()

    loop = asyncio.new_event_loop()
    loop.run_until_complete(run())
    loop.close()
    assert failures == []
