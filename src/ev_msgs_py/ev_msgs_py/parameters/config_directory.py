"""Where vehicles, surfaces, cycles and scenarios are found."""

from __future__ import annotations

import os
from pathlib import Path

VARIABLE = "EV_STACK_CONFIG"


def config_directory() -> Path:
    """Give the config folder: the one that EV_STACK_CONFIG names, else the one installed with ev_sim.

    Raises FileNotFoundError, with a message for the user, when there is none.
    """
    named = os.environ.get(VARIABLE)
    directory = Path(named) if named else _installed()
    if directory is None:
        raise FileNotFoundError(f"no config folder: set {VARIABLE} or source the workspace's install/local_setup.bash")
    if not directory.is_dir():
        origin = f"named by {VARIABLE}" if named else "installed with ev_sim"
        raise FileNotFoundError(f"the config folder {directory}, {origin}, is not there")
    return directory


def _installed() -> Path | None:
    try:
        from ament_index_python.packages import PackageNotFoundError, get_package_share_directory
    except ImportError:
        return None
    try:
        return Path(get_package_share_directory("ev_sim")) / "config"
    except PackageNotFoundError:
        return None
