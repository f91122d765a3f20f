"""Every module of the core can be imported by itself."""

import subprocess
import sys
from pkgutil import walk_packages

import pytest

import ev_core

MODULES = [module.name for module in walk_packages(ev_core.__path__, "ev_core.")]


@pytest.mark.parametrize("module", MODULES)
def test_module_imports_alone(module: str):
    subprocess.run([sys.executable, "-c", f"import {module}"], check=True)
