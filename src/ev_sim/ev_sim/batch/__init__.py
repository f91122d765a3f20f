"""Many runs of one graph in one call (docs/batch.md). The package is called as `ev_sim.batch(...)`."""

from ev_sim.interface.callable_package import make_callable

make_callable(__name__)
