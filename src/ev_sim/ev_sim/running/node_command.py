"""By which command the node of a role is started."""

from __future__ import annotations

import os
from pathlib import Path

from ev_msgs_py.contract.roles import RECORDER
from ev_msgs_py.lockstep.methods import node_package
from ev_sim.running.outcome import RunFailed


def package_of(node: str) -> str:
    """The package with the node of a role, or with the recorder; LookupError as `node_package`."""
    return __package__.partition(".")[0] if node == RECORDER else node_package(node)


def command(name: str) -> list[str]:
    """What `ros2 run` would start for the node of a role: that itself would not hand on the line to the runner.

    RunFailed if the workspace is not built or not sourced, or if the node comes from several packages.
    """
    try:
        package = package_of(name)
    except LookupError as error:
        raise RunFailed(str(error)) from None
    for prefix in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep):
        path = Path(prefix) / "lib" / package / name
        if path.exists():
            return [str(path)]
    raise RunFailed(f"executable {package} {name} is not found: source install/local_setup.bash of the workspace")
