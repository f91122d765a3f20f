"""ev-stack parameters SCENARIO: what every node of a run is told, as a ROS parameter file, and how it is started.

For who starts nodes by other means than scripts/run.sh, such as launch files (launch/scenario.launch.py).
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

from ev_core.parameters.data_file import config_folders
from ev_msgs_py.refusal import ParameterError
from ev_sim.command_line.options import add_overrides, overrides
from ev_sim.command_line.refusal import Parser, refuse
from ev_sim.interface.driving import only_run
from ev_sim.recording.files_of_run import PARAMETERS
from ev_sim.recording.outcome import RunFailed
from ev_sim.running.node_parameters import node_parameters, write_parameter_file
from ev_sim.running.node_process import package_of
from ev_sim.running.output_folder import OutputFolder


def main(argv: list[str] | None = None) -> None:
    """ev-stack parameters SCENARIO --out DIR; standard output is JSON."""
    parser = Parser(prog="ev-stack parameters", description=__doc__)
    parser.add_argument("scenario", help="name or path of a scenario")
    parser.add_argument("--run", default="", metavar="NAME", help="which of its runs, if it has several")
    parser.add_argument("--realtime", action="store_true", help="by the wall clock instead of in lockstep")
    add_overrides(parser)
    parser.add_argument("--no-record", action="store_true", help="no bag")
    parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="where the recorder shall write")
    given = parser.parse_args(sys.argv[1:] if argv is None else argv)
    try:
        run = only_run(given.scenario, given.run, overrides(given))
        with OutputFolder(given.out, "parameters", runs=(run,)) as folder:
            nodes = node_parameters(run, folder.directory, bag=not given.no_record)
            file = folder.directory / PARAMETERS
            write_parameter_file(file, run, nodes)
            folder.hand_over()
        started = [{"package": package_of(name), "executable": name} for name in nodes]
    except (ParameterError, RunFailed, LookupError, OSError) as error:
        refuse(error)
    layout = config_folders()[-1] / "layouts" / "car.rviz"
    said = {"namespace": run.namespace, "parameters": str(file), "nodes": started, "rviz": str(layout)}
    print(json.dumps(said, indent=2))
