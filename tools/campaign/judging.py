"""What came of a trial, in one word and, where it is a failure, in a line."""

from __future__ import annotations

import json
import re
from dataclasses import dataclass

from campaign.trial import Trial
from campaign.under_way import UnderWay

RIGHT, NAMED, INTERRUPTED, KILLED, SKIPPED, FAILED = (
    "right result", "named stop", "named, then Ctrl-C", "killed runner", "skipped", "failure",
)  # fmt: skip
OUTCOMES = (RIGHT, NAMED, INTERRUPTED, KILLED, SKIPPED, FAILED)
_LAST_WORD = re.compile(r"^(?:error: .*|stopped|run\.sh: error: .*|ev-stack: .*)$", re.MULTILINE)
_OBEYED = re.compile(r"[^\n -~\xa0-\U0010ffff]")  # \r, as of a progress bar, is a line break here
_NOTICED = re.compile(r"/ev/\w+: \d+ nodes are called \S+, expected one")


@dataclass(frozen=True)
class Verdict:
    """What came of a trial."""

    trial: Trial
    outcome: str
    remark: str = ""
    struck: bool = False
    seconds: float = 0.0  # of wall time, from the fault (or from the start) to the end


def judged(run: UnderWay, status: int | None) -> tuple[str, str]:
    """Outcome and, of a failure, what is wrong; what is left behind is looked at apart."""
    trial, text = run.trial, run.text()
    if status is None:
        return FAILED, "no end"
    tracebacks = [
        text,
        *(log.read_text(errors="replace") for log in trial.out.glob("**/log/*.log")),
    ]
    for said in tracebacks:
        if "Traceback (most recent" in said:
            return FAILED, f"a traceback: {said[said.index('Traceback') :]}"
    if found := _OBEYED.search(text):
        return (
            FAILED,
            f"what a terminal obeys is in {text[max(found.start() - 80, 0) : found.end() + 80]!r}",
        )
    if status == 0:
        return _right(trial, text)
    if status < 0:
        # A signal before the program could say anything; its status says all that there is to say.
        ours = trial.kind in ("kill", "terminate", "interrupt") or (trial.kind, status) == (
            "stop for ever",
            -9,
        )
        silent = status == -9 or not _LAST_WORD.search(text)
        return (
            (KILLED, "")
            if ours and run.struck and silent
            else (FAILED, f"ended by signal {-status}")
        )
    words = _LAST_WORD.findall(text)
    if len(words) != 1:
        return FAILED, f"status {status} with {len(words)} last words: {words}"
    if run.interrupted:
        return (
            (INTERRUPTED, "")
            if words == ["stopped"] and status == 130
            else (FAILED, f"{status}: {words[0]}")
        )
    if trial.names and (run.struck or trial.from_the_start):
        return (
            (NAMED, "")
            if re.search(trial.names, words[0])
            else (FAILED, f"names something else: {words[0]}")
        )
    if trial.kind in ("bad parameter", "bad file", "modelled faults"):
        expected = trial.expected()
        return (
            (NAMED, "")
            if expected.startswith("refused")
            else (FAILED, f"offline it is driven: {words[0]}")
        )
    return FAILED, f"ended although nothing was wrong: {words[0]}"


def _right(trial: Trial, text: str) -> tuple[str, str]:
    if invented := re.search("^error: .*", text, re.MULTILINE):
        return FAILED, f"status 0 with an error: {invented[0]}"
    summary = json.loads((trial.out / "summary.json").read_text())
    if summary["simulated_time"] != trial.duration:
        return FAILED, f"{summary['simulated_time']} s were driven, not {trial.duration}"
    if trial.way == "real time":
        return (
            (RIGHT, "")
            if not summary["reproducible"]
            else (FAILED, "real time called itself reproducible")
        )
    expected = trial.expected()
    if summary["signal_hash"] == expected:
        return RIGHT, ""
    if trial.kind == "bad live parameter" and not summary["reproducible"]:
        return RIGHT, ""  # it was a value that the parameter may have
    if trial.has_twin and any(_NOTICED.match(reason) for reason in summary["not_reproducible"]):
        return RIGHT, ""  # and marked as what it is
    return FAILED, f"another hash, {summary['signal_hash'][:8]}, not {expected[:80]}"
