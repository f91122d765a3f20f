"""Two network namespaces with a cable between them.

In one what is tried, in the other a stranger.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from helpers.sockets_of_process import Socket

# for documentation (RFC 5737), within the namespaces alone
HERE, THERE = "198.51.100.1", "198.51.100.2"
CABLE = "cable"


class NoNamespaces(Exception):
    """Why there are none here."""


class Network:
    """The namespaces, until it is closed.

    NoNamespaces if this machine or this user cannot make them.
    """

    def __init__(self) -> None:
        if os.geteuid() != 0:
            raise NoNamespaces("network namespaces need root")
        if shutil.which("ip") is None:
            raise NoNamespaces("network namespaces need `ip` of iproute2")
        self.here, self.there = f"ev_here_{os.getpid()}", f"ev_there_{os.getpid()}"
        self._stranger: subprocess.Popen | None = None
        try:
            for words in self._making():
                subprocess.run(["ip", *words.split()], check=True, capture_output=True, text=True)
        except subprocess.CalledProcessError as error:
            self.close()
            raise NoNamespaces(f"no network namespaces here: {error.stderr.strip()}") from None
        subprocess.run(
            [*self.inside, "sh", "-c", "echo 0 >/proc/sys/net/ipv4/icmp_ratelimit"], check=True
        )
        self._stranger = subprocess.Popen(
            [
                "ip",
                "netns",
                "exec",
                self.there,
                sys.executable,
                Path(__file__).with_name("stranger.py"),
            ],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )

    def _making(self) -> Iterable[str]:
        yield f"netns add {self.here}"
        yield f"netns add {self.there}"
        yield f"link add {CABLE} netns {self.here} type veth peer name {CABLE} netns {self.there}"
        for name, address in ((self.here, HERE), (self.there, THERE)):
            yield f"-n {name} address add {address}/24 dev {CABLE}"
            yield f"-n {name} link set lo up"
            yield f"-n {name} link set {CABLE} up"
            yield f"-n {name} route add default dev {CABLE}"

    @property
    def inside(self) -> list[str]:
        """Words in front of a program that shall run here."""
        return ["ip", "netns", "exec", self.here]

    def ask(self, *words: Any) -> list[str]:
        """The stranger's answer."""
        assert self._stranger is not None and self._stranger.stdin and self._stranger.stdout
        self._stranger.stdin.write(f"{json.dumps(words)}\n")
        self._stranger.stdin.flush()
        return json.loads(self._stranger.stdout.readline())

    def not_refused(self, sockets: Iterable[Socket]) -> list[str]:
        """Return the ports of these sockets that do not refuse the stranger."""
        ports = {
            kind: sorted({s.port for s in sockets if s.port and s.protocol.startswith(kind)})
            for kind in ("tcp", "udp")
        }
        return self.ask(HERE, ports["tcp"], ports["udp"])

    def groups(self) -> set[str]:
        """Multicast groups that are joined on the cable, without that of all machines."""
        shown = json.loads(
            subprocess.check_output(
                ["ip", "-n", self.here, "-json", "maddress", "show", "dev", CABLE]
            )
        )
        found = {
            each["address"]
            for link in shown
            for each in link["maddr"]
            if each.get("family") == "inet"
        }
        return found - {"224.0.0.1"}

    def close(self) -> None:
        """Take everything away again."""
        if self._stranger is not None:
            self._stranger.kill()
            self._stranger.communicate()
        for name in (self.here, self.there):
            subprocess.run(["ip", "netns", "delete", name], check=False, capture_output=True)
