"""Where vehicles, surfaces, cycles and scenarios are found."""

from __future__ import annotations

import os
from pathlib import Path

VARIABLE = "EV_STACK_CONFIG"
_RESOURCE = "ev_stack_config"  # of the ament index: packages with a config folder in their share folder


def config_directory() -> Path:
    """Give the config folder: the one that EV_STACK_CONFIG names, else the one that is installed.

    Raises FileNotFoundError, with a message for the user, when there is none.
    """
    named = os.environ.get(VARIABLE)
    directory = Path(named) if named else _installed()
    if directory is None:
        raise FileNotFoundError(f"no config folder: set {VARIABLE} or source the workspace's install/local_setup.bash")
    if not directory.is_dir():
        origin = f"named by {VARIABLE}" if named else "installed"
        raise FileNotFoundError(f"the config folder {directory}, {origin}, is not there")
    return directory


def _installed() -> Path | None:
    try:
        from ament_index_python import get_resources
    except ImportError:
        return None
    try:
        offered = get_resources(_RESOURCE)
    except OSError:  # no workspace is sourced
        return None
    for package, prefix in offered.items():
        return Path(prefix) / "share" / package / "config"
    return None
