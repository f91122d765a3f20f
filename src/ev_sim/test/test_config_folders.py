"""Config folders are found from a checkout, a wheel, and a user's folder; a user's own go first."""

from pathlib import Path

import pytest

from ev_core.parameters.data_file import VARIABLE, config_folders, files_in_config, find_in_config


def test_folders_of_ones_own_go_before_the_installed_one(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
):
    first, second = tmp_path / "first", tmp_path / "second"
    for folder in (first, second):
        (folder / "vehicles").mkdir(parents=True)
        (folder / "vehicles" / "mine.yaml").touch()
    monkeypatch.setenv(VARIABLE, f"{first}:{second}")
    vehicles = files_in_config("vehicles")
    assert (
        vehicles["mine"] == find_in_config("vehicles/mine.yaml") == first / "vehicles" / "mine.yaml"
    )
    assert vehicles["audi_a2"].exists()
    assert find_in_config("vehicles/unknown.yaml") is None


def test_installed_folder_has_the_files_of_the_repository(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.delenv(VARIABLE, raising=False)
    source = Path(__file__).parents[3] / "config"
    (installed,) = config_folders()
    wanted = {path.relative_to(source) for path in source.rglob("*") if path.is_file()}
    assert wanted == {
        path.relative_to(installed) for path in installed.rglob("*") if path.is_file()
    }


def test_missing_folder_is_named(monkeypatch: pytest.MonkeyPatch, tmp_path: Path):
    monkeypatch.setenv(VARIABLE, str(tmp_path / "nowhere"))
    with pytest.raises(FileNotFoundError, match=f"nowhere, named by {VARIABLE}, is not there"):
        config_folders()
