"""The settings of each tool stand in one file, setup.cfg where the tool reads it."""

import configparser
import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[2]
IN_SETUP_CFG = {"tool:pytest", "coverage:run", "coverage:report", "mypy"}


def test_pytest_coverage_and_mypy_are_set_in_setup_cfg_alone():
    """Another file of these tools would go before setup.cfg, or be ignored, without a message."""
    settings = configparser.ConfigParser()
    settings.read(ROOT / "setup.cfg")
    assert set(settings.sections()) >= IN_SETUP_CFG
    assert set(tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]) == {"ruff"}
    for name in ("pytest.ini", ".pytest.ini", "tox.ini", "mypy.ini", ".mypy.ini", ".coveragerc"):
        assert not (ROOT / name).exists(), name


def test_the_suite_runs_with_these_settings(pytestconfig):
    assert pytestconfig.inipath == ROOT / "setup.cfg"
    assert pytestconfig.getini("xfail_strict")
