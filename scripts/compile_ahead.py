"""Compile what a run needs while the workspace is set up: `code [WORDS]` by numba, `imports` to bytecode.

Code is that of the run that WORDS, behind scripts/run.sh, ask for; without a scenario it is what
steps the nodes of every run. It needs the packages that prepare.sh installs first. The methods of
other packages are not known yet: what is missing here, the run compiles.
"""

import os
import sys
from collections.abc import Sequence
from contextlib import suppress
from importlib import import_module
from pathlib import Path
from pkgutil import iter_modules

IMPORTED = (
    "ev_control.nodes",
    "ev_papers",
    "ev_sim.nodes",
    "matplotlib.backends.backend_agg",
    "matplotlib.figure",
    "ev_stack.commands.drive_scenario",
    "ev_stack.commands.run_scenario",
    "ev_stack.recorder_node",
    "ev_stack.report.page.writing",
    "ev_stack.running.processes",
    "ev_study.studies.run_study",
    "ev_study.verdicts",
    "matplotlib.style",
    "PIL.JpegImagePlugin",
    "rosbags.typesys.stores.ros2_jazzy",
    "sensor_msgs.msg",
    "type_description_interfaces.msg",
)


def compile_code(words: Sequence[str]) -> None:
    """Compile for a run; for words that are none, which the run refuses, what steps nodes."""
    import ev_bench.methods
    import ev_control.methods
    import ev_sim.methods
    from ev_core.parameters.data_file import VARIABLE
    from ev_msgs_py.contract.fields import SignalError
    from ev_msgs_py.refusal import ParameterError
    from ev_stack.command_line.options import arguments, overrides, own_nodes
    from ev_stack.running.beforehand import compile_for, compile_units, stepping
    from ev_stack.scenarios.scenario import load_scenario

    os.environ.setdefault(VARIABLE, str(Path(__file__).resolve().parents[1] / "config"))
    for package in (ev_control.methods, ev_sim.methods, ev_bench.methods):
        for module in iter_modules(package.__path__, f"{package.__name__}."):
            import_module(module.name)
    try:
        given = arguments(words)
        runs = load_scenario(given.scenario, overrides(given), given.run).runs
    except (ParameterError, SignalError, OSError, SystemExit):
        compile_units(stepping(in_nodes=True))
    else:
        compile_for(runs, not given.offline, own_nodes(given))


if __name__ == "__main__":
    if sys.argv[1] == "code":
        compile_code(sys.argv[2:])
    else:
        for name in IMPORTED:
            with suppress(ImportError):  # of what another distribution of ROS has not
                import_module(name)
