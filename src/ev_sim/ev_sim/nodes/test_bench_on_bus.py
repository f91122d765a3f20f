"""What makes of the node of the role test_bench one in real time, with its inverters on a CAN bus."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from ev_core.bus.channel import BusMeter, Channels
from ev_core.lockstep.configuration import Configuration
from ev_core.nodes.bus_nodes import RoleOnBus
from ev_sim.test_bench.bench_on_bus import BenchOnBus, meters_of


class OnBus(RoleOnBus):
    """A base before that of the node: its bench has its inverters on the bus."""

    _meters: Mapping[str, BusMeter] = MappingProxyType({})

    def played_by(self, configuration: Configuration) -> BenchOnBus:
        """A bench at rest."""
        return BenchOnBus(configuration, self._meters_of(configuration))

    def open_channels(self) -> Channels:
        """Those of its parameters, with meters; the log is the gateway's."""
        return Channels(self.configuration.parameters.bus, meters=self._meters_of(self.configuration))

    def _meters_of(self, configuration: Configuration) -> Mapping[str, BusMeter]:
        if not self._meters:
            self._meters = meters_of(configuration.parameters.bus.database)
        return self._meters
