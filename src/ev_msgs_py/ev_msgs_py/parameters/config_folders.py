"""Where vehicles, surfaces, cycles and scenarios are found: in your own folders, then in installed packages."""

from __future__ import annotations

import os
from collections.abc import Mapping
from functools import cache
from importlib.metadata import entry_points
from importlib.util import find_spec
from pathlib import Path

VARIABLE = "EV_STACK_CONFIG"
_GROUP = "ev_stack.config"  # of entry points: packages that have a folder `config`


def config_folders() -> tuple[Path, ...]:
    """The folders that EV_STACK_CONFIG names, separated as in PATH, and behind them those of installed packages.

    What stands in several of them is taken from the first. FileNotFoundError, with a message for the user, if one that
    is named is not there.
    """
    named = [Path(text) for text in os.environ.get(VARIABLE, "").split(os.pathsep) if text]
    for folder in named:
        if not folder.is_dir():
            raise FileNotFoundError(f"the config folder {folder}, named by {VARIABLE}, is not there")
    return (*named, *_installed())


@cache
def _installed() -> tuple[Path, ...]:
    packages = sorted({point.value for point in entry_points(group=_GROUP)})
    return tuple(Path(folder) / "config" for name in packages for folder in _locations(name))


def _locations(package: str) -> list[str]:
    spec = find_spec(package)
    return list(spec.submodule_search_locations or ()) if spec is not None else []


def find_in_config(name: str) -> Path | None:
    """The file or folder of a name such as cycles/nedc.csv in the first config folder that has it; None if none has."""
    return next((path for folder in config_folders() if (path := folder / name).exists()), None)


def files_in_config(kind: str) -> Mapping[str, Path]:
    """By name, without suffix, every YAML file of a kind, which is `scenarios`, `vehicles` or `surfaces`."""
    found: dict[str, Path] = {}
    for folder in config_folders():
        for path in sorted((folder / kind).glob("*.yaml")):
            found.setdefault(path.stem, path)
    return found
