"""The command line of scripts/run.sh: what its words mean, and what is refused."""

from __future__ import annotations

import signal
import sys
from contextlib import suppress
from pathlib import Path
from types import SimpleNamespace

import pytest

from ev_msgs_py.refusal import ParameterError
from ev_nodes.stepping import stop_request
from ev_stack.command_line import offered_commands
from ev_stack.command_line.options import arguments, overrides, own_nodes
from ev_stack.commands import program
from ev_stack.commands.run_scenario import main


def values(*words: str) -> list:
    return list(overrides(arguments(["shchur2019", *words])).values)


def refused(*words: str) -> str:
    given = arguments(["shchur2019", *words])
    with pytest.raises(ParameterError) as error:
        own_nodes(given)
        overrides(given)
    text = str(error.value)
    assert "\n" not in text
    return text


def test_a_name_alone_runs_the_scenario_as_its_files_say():
    given = arguments(["shchur2019"])
    assert (given.scenario, given.offline, given.in_process, given.no_record) == (
        "shchur2019",
        False,
        False,
        False,
    )
    plain = overrides(given)
    assert (list(plain.files), list(plain.values), plain.duration) == ([], [], None)
    assert own_nodes(given) == {}


def test_what_the_options_mean():
    words = [
        "shchur2019",
        "--offline",
        "--params",
        "a.yaml",
        "--params",
        "b.yaml",
        "--duration",
        "2.5 s",
        "--out",
        "x",
    ]
    given = arguments([*words, "--no-record", "--seed", "7"])
    assert (given.offline, given.no_record, given.out) == (True, True, Path("x"))
    found = overrides(given)
    assert (list(found.files), found.duration) == ([Path("a.yaml"), Path("b.yaml")], 2.5)
    assert list(found.values) == [("*", "seed", 7)]
    assert values("--realtime") == [("*", "mode", "realtime")]


def test_methods_and_parameters_go_to_their_node_in_order():
    """The first dot ends the node, the first = ends the parameter."""
    assert values("--method", "asr=off", "--method", "asr=x") == [
        ("asr", "method", "off"),
        ("asr", "method", "x"),
    ]
    assert values("--set", "driver.steering.mode=angle") == [("driver", "steering.mode", "angle")]
    assert values("--set", "plant.name=a=b.c") == [("plant", "name", "a=b.c")]


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("5", 5),
        ("5.0", 5.0),
        ("1e-3", 0.001),
        ("-1E3", -1000.0),
        ("true", True),
        ("off", False),
        ("ideal", "ideal"),
        ("'5'", "5"),
        ("[0, 1e-3, 2.5]", [0, 0.001, 2.5]),
        ("[front_left, rear_left]", ["front_left", "rear_left"]),
        ("''", ""),
        ("a b", "a b"),
    ],
)
def test_a_value_is_read_as_a_parameter_file_would_read_it(text, value):
    ((_, _, parsed),) = values("--set", f"plant.x={text}")
    assert parsed == value
    assert type(parsed) is type(value)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--method", "asr"], "--method 'asr' is refused, expected NODE=NAME"),
        (["--method", "=off"], "--method '=off' is refused, expected NODE=NAME"),
        (["--method", "asr="], "--method 'asr=' is refused, expected NODE=NAME"),
        (["--set", "plant.drive"], "--set 'plant.drive' is refused, expected NODE.PARAM=VALUE"),
        (["--set", "drive=ideal"], "--set 'drive' is refused, expected NODE.PARAM=VALUE"),
        (["--set", ".drive=ideal"], "--set '.drive' is refused, expected NODE.PARAM=VALUE"),
        (["--set", "plant.=ideal"], "--set 'plant.' is refused, expected NODE.PARAM=VALUE"),
        (["--set", "plant.x=[1, 2"], "--set: '[1, 2' is no YAML value"),
        (["--set", "plant.x=2026-99-99"], "--set: '2026-99-99' is no YAML value"),
        (["--node", "driver"], "--node 'driver' is refused, expected NODE=COMMAND"),
        (
            ["--node", "drivr=./mine"],
            "unknown node 'drivr'; did you mean driver? known: asr, driver, ",
        ),
        (
            ["--node", "driver=./mine 'x"],
            '--node "driver=./mine \'x" is refused: No closing quotation',
        ),
    ],
)
def test_words_without_sense_are_one_line(words, message):
    assert refused(*words).startswith(message)


def test_a_node_of_ones_own_is_a_command_with_its_arguments():
    given = arguments(
        ["shchur2019", "--node", "asr=python3 'my asr.py' --fast", "--node", "driver=./d"]
    )
    assert own_nodes(given) == {"asr": ["python3", "my asr.py", "--fast"], "driver": ["./d"]}


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ([], "which scenario? --list shows them"),
        (["coast_down", "b"], "unrecognized arguments: b"),
        (["coast_down", "--fast"], "unrecognized arguments: --fast"),
        (["coast_down", "--offline", "--in-process"], "not allowed with argument"),
        (["coast_down", "--offline", "--realtime"], "--realtime needs DDS"),
        (["coast_down", "--offline", "--node", "asr=x"], "--node starts a process"),
        (["coast_down", "--in-process", "--node", "asr=x"], "--node starts a process"),
        (["coast_down", "--seed", "1.5"], "invalid int value: '1.5'"),
        (
            ["coast_down", "--duration", "long"],
            "argument --duration: 'long' is refused, expected a number of seconds",
        ),
        (["coast_down", "--set"], "expected one argument"),
    ],
)
def test_unknown_words_end_with_status_2(words, message, capsys):
    """The status that argparse and most commands give for a wrong command line."""
    with pytest.raises(SystemExit) as ended:
        arguments(words)
    assert ended.value.code == 2
    assert message in capsys.readouterr().err


_NO_SNOW = "plant: road.left: unknown surface 'snow'; did you mean packed_snow_1, packed_snow_2?"


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["nowhere"], "unknown scenario, study or review 'nowhere'; known: "),
        (["sweeep", "x"], "unknown scenario, study or review 'sweeep'; did you mean sweep?"),
        (["straight_brake_split_mu", "--set", "plant.road.left=[snow]"], _NO_SNOW),
        (
            ["shchur2019", "--set", "plant.drive=magic"],
            "plant: parameter drive: 'magic' is refused, ",
        ),
        (["shchur2019", "--method", "asr=on"], "asr: unknown asr method 'on'; known: "),
        (["shchur2019", "--duration", "-1"], "duration: -1.0 is refused"),
        (["shchur2019", "--params", "nowhere.yaml"], "nowhere.yaml: No such file or directory"),
    ],
)
def test_what_is_refused_ends_the_command_with_one_line_and_leaves_nothing(
    words, message, tmp_path
):
    """sys.exit with a text prints it and gives status 1; the output folder is not even made."""
    out = tmp_path / "out"
    with pytest.raises(SystemExit) as ended:
        main([*words, "--offline", "--out", str(out)])
    assert ended.value.code.startswith(f"error: {message}")
    assert "\n" not in ended.value.code
    assert not out.exists()


@pytest.mark.parametrize(
    ("set_", "message"),
    [
        (
            "*.control_period=0.0133",
            "note: shchur2019 ends at 0.9975 s: 1 s is no multiple of control_period, 0.0133 s",
        ),
        (
            "plant.initial_speed=80",
            "note: plant.initial_speed = 80 m/s is 288 km/h; km/h are written '80 km/h'",
        ),
    ],
)
def test_what_may_not_be_meant_is_one_note(set_, message, tmp_path, capsys):
    """A run that would end early, or drive at 288 km/h, has a note."""
    words = ["shchur2019", "--offline", "--no-record", "--no-report", "--duration", "1"]
    main([*words, "--set", set_, "--out", str(tmp_path / "odd")])
    assert message in capsys.readouterr().out.splitlines()
    main([*words, "--out", str(tmp_path / "out")])
    assert "note: " not in capsys.readouterr().out


@pytest.mark.parametrize(
    ("word", "message"),
    [
        ("rnu", "unknown command 'rnu'; did you mean run?"),
        ("sweeep", "unknown command 'sweeep'; did you mean sweep"),
        ("sweep", "'sweep' is no command: ev-stack run sweep\n"),
        ("shchur2019", "'shchur2019' is no command: ev-stack run shchur2019\n"),
    ],
)
def test_a_command_of_ev_stack_asks_for_the_similar_one(word, message, capsys):
    with pytest.raises(SystemExit) as ended:
        program.perform([word])
    assert ended.value.code == 2
    assert capsys.readouterr().err.startswith(f"ev-stack: {message}")


def test_list_shows_every_scenario_and_method_in_a_line(capsys):
    main(["--list"])
    lines = capsys.readouterr().out.splitlines()
    assert any(line.split()[0] == "shchur2019" and "Fig 4" in line for line in lines)
    assert any(line.split()[0] == "power_steering" for line in lines)
    assert "methods of asr" in lines
    assert all(len(line.split()) > 1 or line == "scenarios" for line in lines)


@pytest.fixture
def command(monkeypatch):
    """`ev-stack run shchur2019` in this process, which is as it was afterwards."""
    before = {kind: signal.getsignal(kind) for kind in (signal.SIGINT, signal.SIGTERM)}
    # ignored where tests run in the background
    signal.signal(signal.SIGINT, signal.default_int_handler)
    monkeypatch.setattr(sys, "argv", ["ev-stack", "run", "shchur2019"])
    # its tables are imported here, before a test replaces `import_module`
    offered_commands.offered_commands()
    monkeypatch.setattr(stop_request, "_INTERRUPTS", [])
    monkeypatch.setattr(program, "turn_deaf", lambda: None)
    monkeypatch.setattr(stop_request, "turn_deaf", lambda: None)
    monkeypatch.setattr(stop_request.atexit, "_run_exitfuncs", lambda: None)
    monkeypatch.setattr(stop_request.os, "_exit", sys.exit)
    yield program.main
    for kind, handler in before.items():
        signal.signal(kind, handler)


@pytest.mark.parametrize("when", ["loading", "driving"])
def test_ctrl_c_is_one_line_from_the_first_moment(when, command, monkeypatch, capsys):
    """Loading takes half a second and is interrupted more often than the work."""

    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    module = SimpleNamespace(main=interrupted)
    monkeypatch.setattr(
        offered_commands, "import_module", interrupted if when == "loading" else lambda name: module
    )
    with pytest.raises(SystemExit) as ended:
        command()
    assert ended.value.code == 130
    assert capsys.readouterr() == ("", "stopped\n")


@pytest.mark.parametrize(
    "error", [RuntimeError("no compiled object yet"), SystemExit("error: no method is loaded")]
)
@pytest.mark.parametrize("interrupted", [True, False])
def test_an_error_that_ctrl_c_has_made_is_one_line_and_any_other_is_shown(
    interrupted, error, command, monkeypatch, capsys
):
    """The compiler gets no Ctrl-C in a callback, and goes on without its result.

    Python itself makes another error of it where a class is being made: no method of that module is
    known then.
    """

    def compile_it(*_: object) -> None:
        if interrupted:
            with suppress(KeyboardInterrupt):
                signal.raise_signal(signal.SIGINT)
        raise error

    monkeypatch.setattr(
        offered_commands, "import_module", lambda name: SimpleNamespace(main=compile_it)
    )
    with pytest.raises(SystemExit if interrupted else type(error)) as ended:
        command()
    assert ended.value is error or ended.value.code == 130
    assert capsys.readouterr().err == ("stopped\n" if interrupted else "")


@pytest.mark.parametrize(
    ("error", "status", "message"),
    [(None, 0, ""), ("error: no nodes", 1, "error: no nodes\n"), (2, 2, "")],
)
def test_a_command_with_a_participant_ends_without_deleting_it(
    error, status, message, command, monkeypatch, capsys
):
    """Deleting one may wait for ever; status and line are as Python's own end gives them."""
    monkeypatch.setattr(stop_request, "KEPT", kept := ["a participant"])
    monkeypatch.setattr(program, "KEPT", kept)

    def perform(*_: object) -> None:
        if error is not None:
            raise SystemExit(error)

    monkeypatch.setattr(
        offered_commands, "import_module", lambda name: SimpleNamespace(main=perform)
    )
    with pytest.raises(SystemExit) as ended:
        command()
    assert ended.value.code == status
    assert capsys.readouterr().err == message
