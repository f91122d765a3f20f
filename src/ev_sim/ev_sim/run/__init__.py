"""Driving scenarios: offline, in one process, as processes. The package is called as `ev_sim.run(...)`."""

from ev_sim.interface.callable_package import make_callable

make_callable(__name__)
