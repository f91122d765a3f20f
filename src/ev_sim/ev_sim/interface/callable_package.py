"""A package that can be called: `ev_sim.run(...)`, beside the modules of `ev_sim.run`."""

from __future__ import annotations

import sys
from importlib import import_module
from types import ModuleType
from typing import Any


class _CallablePackage(ModuleType):
    """A package that stands for a function of the same name in `ev_sim.interface.driving`."""

    def __call__(self, *arguments: Any, **named: Any) -> Any:
        driving = import_module("ev_sim.interface.driving")  # which drives, and so is slow to import
        return getattr(driving, self.__name__.rpartition(".")[2])(*arguments, **named)


def make_callable(package: str) -> None:
    """Let a package be called as the function of its name."""
    sys.modules[package].__class__ = _CallablePackage
