"""Packages that only some uses need: imported by these, and named in one line where they are missing."""

from __future__ import annotations

from importlib import import_module
from typing import Any


def extra(module: str, name: str) -> Any:
    """A module of an extra of ev_sim; ImportError that says how to get it."""
    try:
        return import_module(module)
    except ImportError as error:
        raise ImportError(f"{module} cannot be imported ({error}): pip install 'ev_sim[{name}]'") from None
