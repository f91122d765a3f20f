"""The stack from Python, without ROS: `ev_stack.run`, `ev_stack.Simulation` and `ev_stack.batch` (docs/python.md)."""

from importlib import import_module
from typing import Any


def extra(module: str, name: str) -> Any:
    """A module of an extra such as ev_doors[gymnasium]; ImportError with how to get it."""
    try:
        return import_module(module)
    except ImportError as error:
        raise ImportError(f"{module} cannot be imported ({error}): pip install '{name}'") from None
