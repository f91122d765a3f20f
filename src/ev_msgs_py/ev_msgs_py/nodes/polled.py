"""A node that `spinning.spin` polls for what its next step waits for."""

from __future__ import annotations

from ev_msgs_py.nodes.signal_io import SignalReader, SubscriptionHandle

_LOOK_PERIOD = 0.02  # s of wall time between looks for what nobody waits for: repetitions of messages


class Polled:
    """Takes messages from its `readers`; `wanted` says which of them the next step waits for."""

    readers: dict[type, SignalReader]

    def wanted(self) -> tuple[type, ...]:
        """The signals that the next step waits for, in the order of their arrival."""
        raise NotImplementedError

    def poll(self) -> bool:
        """Take what the next step waits for and step where that completes the inputs; False if nothing was there."""
        progressed = False
        for signal in self.wanted():
            reader = self.readers[signal]
            message = reader.take()
            if message is not None:
                reader.receive(message)
                progressed = True
        return progressed

    def sweep(self) -> None:
        """Take everything: what nobody waits for are repetitions, and they tell that somebody misses an answer."""
        for reader in self.readers.values():
            while (message := reader.take()) is not None:
                reader.receive(message)

    def forget(self, signal: type) -> None:
        """Take what has come of a signal, if the node reads it, and do nothing with it."""
        while signal in self.readers and self.readers[signal].take() is not None:
            pass

    def awaits(self) -> SubscriptionHandle:
        """The subscription to wake up for: of the inputs that are missing, or of all, the one that arrives last."""
        return self.readers[(self.wanted() or tuple(self.readers))[-1]].handle

    def wake_up_within(self) -> float:
        """Seconds after which the node wants to be polled though no message has come."""
        return _LOOK_PERIOD

    def idle(self) -> None:
        """Called when there is nothing to take."""

    def close(self) -> None:
        """Called at the end of the process."""
