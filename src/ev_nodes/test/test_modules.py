"""Every module of the nodes can be imported by itself."""

import subprocess
import sys
from pkgutil import walk_packages

import pytest

import ev_nodes

MODULES = [module.name for module in walk_packages(ev_nodes.__path__, "ev_nodes.")]


@pytest.mark.parametrize("module", MODULES)
def test_module_imports_alone(module: str):
    subprocess.run([sys.executable, "-c", f"import {module}"], check=True)
