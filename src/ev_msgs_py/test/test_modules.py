"""Every module of the contract can be imported by itself."""

import subprocess
import sys
from pkgutil import walk_packages

import pytest

import ev_msgs_py

MODULES = [module.name for module in walk_packages(ev_msgs_py.__path__, "ev_msgs_py.")]


@pytest.mark.parametrize("module", MODULES)
def test_module_imports_alone(module: str):
    subprocess.run([sys.executable, "-c", f"import {module}"], check=True)
