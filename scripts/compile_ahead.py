"""Compile what every run needs, while the workspace is built: its imports to bytecode, what steps its nodes by numba.

What one scenario alone needs, such as its laws, its first run compiles.
"""

from importlib import import_module
from pkgutil import iter_modules

import ev_control.methods
import ev_sim.methods
from ev_sim.running.beforehand import compile_units, stepping

IMPORTED = (
    "matplotlib.backends.backend_agg",
    "matplotlib.figure",
    "ev_sim.commands.drive_scenario",
    "ev_sim.commands.run_scenario",
    "ev_sim.recording.run_recorder",
    "ev_sim.report.page.writing",
    "ev_sim.running.processes",
    "ev_sim.study.run_study",
)

if __name__ == "__main__":
    for name in IMPORTED:
        import_module(name)
    for package in (ev_control.methods, ev_sim.methods):
        for module in iter_modules(package.__path__, f"{package.__name__}."):
            import_module(module.name)
    compile_units((*stepping(in_nodes=True), *stepping(in_nodes=False)))
