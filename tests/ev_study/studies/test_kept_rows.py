"""Kept rows are used as long as nothing that they depend on has changed, and no longer."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays

from ev_core.lockstep import finding
from ev_core.methods import offered as entry_points
from ev_core.methods import register
from ev_core.parameters.data_file import files_read, find_in_config
from ev_stack.command_line.offered_commands import STUDIES
from ev_stack.recording.outcome import RunFailed
from ev_stack.scenarios import about
from ev_study.studies import digests, kept_rows
from ev_study.studies.kept_rows import KeptRows, MeasureAndSave, keys_of_cases
from ev_study.studies.result_store import Results
from ev_study.studies.study import Case, CaseResult, drive_case

LAW = '''"""A law of the user's own."""

from dataclasses import dataclass

from ev_msgs_py.contract.signals import WheelTorqueCommand, WheelTorqueRequest
from ev_core.methods.register import method


@dataclass(frozen=True)
class Parameters:
    pass


@method("asr", "row_law")
class RowLaw:
    """Passes the request on, less what another module says."""

    parameters = Parameters

    def __init__(self, parameters, vehicle, period):
        from row_law_gain import GAIN

        self.state, self.gain = None, GAIN

    def step(self, request: WheelTorqueRequest) -> WheelTorqueCommand:
        return WheelTorqueCommand(request.drive, request.brake)
'''
DEPENDENTS = {  # by what a file is called the cases that read it
    "profile.csv": {"profile"},
    "own.yaml": {"own scenario"},
    "car.yaml": {"own scenario"},
    "tyre.tir": {"own scenario"},
    "map.csv": {"own scenario"},
    "more.yaml": {"more parameters"},
    "recorded.npz": {"recorded"},
    "bus.dbc": {"bus"},
    "row_law.py": {"law", "law by its path"},
    "row_law_gain.py": {"law", "law by its path"},
    "row_source/report.py": {"own report"},
    "row_source/scale.py": {"own report"},
    "row_source/source.py": {"own report"},
    "row_source/published.csv": {"own report"},
}
OFFERED = {"ev_stack.reports": "row_source.report", "ev_stack.sources": "row_source.source"}


def in_config(name: str) -> Path:
    found = find_in_config(name)
    assert found is not None
    return found


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Iterator[Path]:
    """One file of each kind, and none of them in a config folder."""
    made = tmp_path_factory.mktemp("files")
    (made / "profile.csv").write_text("t_s,v_mps\n0,1\n10,2\n")
    car = in_config("vehicles/compact_ev.yaml").read_text()
    tyre = "tyres/pacejka_2006_205_60r15.tir"
    (made / "tyre.tir").write_bytes(in_config(tyre).read_bytes())
    (made / "map.csv").write_bytes(in_config("efficiency_maps/yasa_400.csv").read_bytes())
    assert car.count(tyre) == 2 and car.count("      motor:\n") == 1
    car = car.replace(tyre, str(made / "tyre.tir"))
    car = car.replace("      motor:\n", f"      motor:\n        map_file: {made / 'map.csv'}\n")
    (made / "car.yaml").write_text(car)
    own = in_config("scenarios/coast_down.yaml").read_text()
    (made / "own.yaml").write_text(own.replace("vehicle: audi_a2", f"vehicle: {made / 'car.yaml'}"))
    (made / "more.yaml").write_text("/**/plant:\n  ros__parameters:\n    initial_speed: 20.0\n")
    drive_case(
        Case("a", "coast_down", duration=0.1),
        MeasureAndSave(lambda recording, run: {}, made / "recorded.npz"),
    )
    (made / "bus.dbc").write_bytes(in_config("can/ev_bench.dbc").read_bytes())
    (made / "row_law.py").write_text(LAW)
    (made / "row_law_gain.py").write_text("GAIN = 1.0\n")
    (made / "row_source").mkdir()
    for name in ("__init__.py", "scale.py", "source.py", "published.csv"):
        (made / "row_source" / name).write_text("# a source of the user's own\n")
    (made / "row_source" / "report.py").write_text("from row_source.scale import SCALE\n")
    (made / "reported.yaml").write_text(own.replace("vehicle: audi_a2", "report: row_source"))
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(made)
        offered = {
            group: {**entry_points.offered(group), "row_source": module}
            for group, module in OFFERED.items()
        }
        for module in (digests, about):
            patch.setattr(
                module, "offered", lambda group: offered.get(group) or entry_points.offered(group)
            )
        importlib.import_module("row_law")
        yield made
        del register._REGISTER["asr"]["row_law"], sys.modules["row_law"]


def cases(folder: Path) -> list[Case]:
    bus = str(folder / "bus.dbc")
    return [
        Case("plain", "coast_down"),
        Case(
            "profile",
            "shchur2019",
            (("driver", "speed_profile.file", str(folder / "profile.csv")),),
        ),
        Case("own scenario", str(folder / "own.yaml")),
        Case("more parameters", "coast_down", files=(folder / "more.yaml",)),
        Case(
            "recorded",
            "coast_down",
            (("driver", "method", str(folder / "recorded.npz")),),
            duration=0.1,
        ),
        Case(
            "bus",
            "bench_fault",
            tuple((n, "bus.database", bus) for n in ("test_bench", "inverter_gateway")),
        ),
        Case("law", "coast_down", (("asr", "method", "row_law"),)),
        Case("law by its path", "coast_down", (("asr", "method", str(folder / "row_law.py")),)),
        Case("own report", str(folder / "reported.yaml")),
    ]


def keys(folder: Path) -> dict[str, str]:
    digests._texts_of.cache_clear()  # another process would begin so
    return {case.name: kept_rows.row_key("sweep", case).digest for case in cases(folder)}


def change(file: Path) -> None:
    """Write other content, which some readers notice and others do not: both need a new row."""
    if file.suffix == ".npz":
        arrays = dict(np.load(file))
        arrays["driver.command.drive_torque"][0] += 1.0
        np.savez(file, **arrays)
    else:
        comment = {".tir": "$ x\n", ".dbc": "\n"}.get(file.suffix, "# x\n")
        file.write_text(file.read_text("latin-1") + comment, "latin-1")


@pytest.fixture(scope="module")
def latest(folder) -> dict[str, str]:
    """The keys of all cases, as they were last asked for."""
    return keys(folder)


@settings(max_examples=8)
@given(st.sets(st.sampled_from(list(DEPENDENTS))))
def test_a_changed_file_changes_the_rows_that_depend_on_it_and_no_others(folder, latest, changed):
    for name in changed:
        change(folder / name)
    now = keys(folder)
    assert {name for name in now if now[name] != latest[name]} == set().union(
        *(DEPENDENTS[c] for c in changed)
    )
    assert len(set(now.values())) == len(now)
    latest |= now


def test_what_is_published_counts_where_a_report_judges_by_it(monkeypatch):
    """A row has metrics of its report; their words and units stand in published.csv."""
    case = Case("report", "shchur2019")
    before = kept_rows.row_key("sweep", case).digest
    assert digests._published() != digests._digest("", ())
    monkeypatch.setattr(digests, "_published", lambda: "other")
    assert kept_rows.row_key("sweep", case).digest != before


def test_a_changed_study_of_ones_own_drives_its_cases_again(tmp_path, monkeypatch):
    (tmp_path / "row_study.py").write_text("TIMES = 1.0\n")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(
        digests, "offered", lambda group: {"own": "row_study"} if group == STUDIES else {}
    )

    def keys() -> list[str]:
        digests._texts_of.cache_clear()
        return [kept_rows.row_key(study, CASE).digest for study in ("own", "sweep")]

    before = keys()
    change(tmp_path / "row_study.py")
    assert [one == other for one, other in zip(before, keys(), strict=True)] == [False, True]


def test_a_module_that_this_python_cannot_read_counts_by_its_text(tmp_path, monkeypatch):
    (tmp_path / "later_study.py").write_text(
        "try:\n    import of_later\nexcept SyntaxError:\n    pass\n"
    )
    (tmp_path / "of_later.py").write_text("def (\n")
    monkeypatch.syspath_prepend(tmp_path)
    assert [each.name for each in digests.imported_files("later_study", ())] == [
        "later_study.py",
        "of_later.py",
    ]


def test_two_files_that_change_places_are_others(tmp_path):
    """Each text still counts, but under the name of the other file."""
    files = (tmp_path / "one.yaml", tmp_path / "two.yaml")
    texts = [f"/**/plant:\n  ros__parameters:\n    initial_speed: {of}\n" for of in ("9.0", "9.00")]
    case = Case("first", "coast_down", files=files)

    def key(*texts: str) -> str:
        for file, text in zip(files, texts, strict=True):
            file.write_text(text)
        return kept_rows.row_key("sweep", case).digest

    assert key(*texts) != key(*reversed(texts))
    assert key(*texts) == key(*texts)


def test_a_library_in_c_is_a_file_that_was_read(tmp_path, monkeypatch):
    library = tmp_path / "liblimit.so"
    library.write_bytes(b"machine code")
    monkeypatch.setattr(
        "ev_core.lockstep.finding.library_method",
        lambda role, name: register.methods_of(role)["off"],
    )
    with files_read() as read:
        finding.find_method("asr", str(library))
    assert list(read) == [str(library)]


CASE = Case("first", "shchur2019", duration=0.1)


def kept(store: Results, *of: Case, study: str = "sweep") -> KeptRows[CaseResult]:
    return KeptRows(store, CaseResult, keys_of_cases(study, of or [CASE]))


def with_duration(duration: float) -> Case:
    return Case(f"{duration:g} s", "shchur2019", duration=duration)


def test_a_row_comes_back_to_the_bit_under_any_name():
    store: dict[str, bytes] = {}
    measured = {"a": 1 / 3, "nan": float("nan"), "b": np.arange(3.0), "c": ("x", None, [True])}
    kept(store).keep("first", CaseResult("first", measured, "hash", 0.1, 0.2, "", ("note",)))
    second = Case("second", CASE.scenario, duration=CASE.duration)
    found = kept(store, second).get("second")
    assert (found.name, found.signal_hash, found.notes) == ("first", "hash", ("note",))
    assert (found.measured["a"], found.measured["c"]) == (measured["a"], measured["c"])
    assert np.array_equal(found.measured["b"], measured["b"])
    other = with_duration(0.2)
    assert kept(store, other).get(other.name) is None
    assert kept(store, study="compare").get("first") is None


ARRAYS = arrays(
    st.sampled_from([np.float64, np.float32, np.int64, np.bool_, np.dtype("<U3")]),
    array_shapes(min_dims=1, max_dims=3, min_side=0, max_side=3),
)
PLAIN = st.none() | st.booleans() | st.integers() | st.floats() | st.text()
NAMES = st.sampled_from(["array", "tuple", "type", "shape"]) | st.text().filter(
    lambda name: "\0" not in name
)
MEASURED = st.recursive(
    PLAIN | ARRAYS,
    lambda of: st.lists(of) | st.lists(of).map(tuple) | st.dictionaries(NAMES, of),
    max_leaves=8,
)


@given(st.dictionaries(NAMES, MEASURED))
def test_whatever_is_measured_comes_back_to_the_bit(measured):
    """Names of metrics are those of users: `tuple` alone, or `array` beside `type`, as well."""
    content = kept_rows.as_json(CaseResult("first", measured))
    assert identical(kept_rows.row_of(CaseResult, content).measured, measured)


def identical(one: object, other: object) -> bool:
    """Return True for equal types and numbers: 0.0 is not -0.0, and one NaN is another one."""
    if type(one) is not type(other):
        return False
    if isinstance(one, np.ndarray):
        kinds = (one.dtype, one.shape) == (other.dtype, other.shape)
        return kinds and repr(one.tolist()) == repr(other.tolist())
    if isinstance(one, dict):
        return one.keys() == other.keys() and all(identical(one[key], other[key]) for key in one)
    if isinstance(one, list | tuple):
        return len(one) == len(other) and all(map(identical, one, other))
    return repr(one) == repr(other)


def test_versions_are_of_all_that_computes():
    assert {"python", "numpy", "scipy", "numba", "llvmlite"} <= digests.versions().keys()


def test_a_file_that_changes_while_it_is_driven_ends_the_study(tmp_path):
    """Its row would stand under the old content, with numbers of the new one."""
    more = tmp_path / "more.yaml"
    more.write_text("/**/asr:\n  ros__parameters:\n    method: 'off'\n")
    case = Case("first", "shchur2019", files=(more,), duration=0.1)
    store: dict[str, bytes] = {}
    rows = kept(store, case)
    change(more)
    expected = r"more\.yaml has changed since the runs began: start them again$"
    with pytest.raises(RunFailed, match=expected):
        rows.keep("first", CaseResult("first", {}))
    assert not store


def test_a_case_that_was_refused_and_is_mended_while_the_others_are_driven_ends_the_study():
    """It has no key: nothing is known of the files with which it has been driven."""
    good = Case("good", "shchur2019", duration=0.1)
    store: dict[str, bytes] = {}
    rows = kept(store, good)
    with pytest.raises(RunFailed, match=r"^mended was refused when the runs began"):
        rows.keep("mended", CaseResult("mended", {}))
    assert not store
