"""The config folder is found from a checkout and from an installation."""

from pathlib import Path

import pytest

from ev_msgs_py.parameters.config_directory import VARIABLE, config_directory


def test_variable_goes_first(monkeypatch: pytest.MonkeyPatch, tmp_path: Path):
    monkeypatch.setenv(VARIABLE, str(tmp_path))
    assert config_directory() == tmp_path


def test_installed_folder_has_the_files_of_the_repository(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.delenv(VARIABLE, raising=False)
    source = Path(__file__).parents[1] / "config"
    installed = config_directory()
    wanted = {path.relative_to(source) for path in source.rglob("*") if path.is_file()}
    assert wanted <= {path.relative_to(installed) for path in installed.rglob("*") if path.is_file()}


def test_missing_folder_is_named(monkeypatch: pytest.MonkeyPatch, tmp_path: Path):
    monkeypatch.setenv(VARIABLE, str(tmp_path / "nowhere"))
    with pytest.raises(FileNotFoundError, match=f"nowhere, named by {VARIABLE}, is not there"):
        config_directory()


def test_without_variable_and_installation_the_way_out_is_named(monkeypatch: pytest.MonkeyPatch, tmp_path: Path):
    monkeypatch.delenv(VARIABLE, raising=False)
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path))
    with pytest.raises(FileNotFoundError, match=f"set {VARIABLE} or source"):
        config_directory()
