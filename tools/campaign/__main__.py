"""scripts/campaign.sh [--count N] [--seed N] [--minutes M] [--only SEED ...] [--page FILE] [--keep DIR]"""

from __future__ import annotations

import argparse
import shutil
import sys
import tempfile
import time
import traceback
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from tqdm import tqdm

from campaign.aftermath import left_behind, shared_memory
from campaign.judging import FAILED, SKIPPED, Verdict, judged
from campaign.kinds import kind_of, turn_of
from campaign.page import part_of, result_text
from campaign.stacks import keep_stacks
from campaign.trial import Skipped, begun
from campaign.under_way import AFTER_STRIKE, PATIENCE, UnderWay
from documentation.markdown import with_blocks

_AT_ONCE = 2
_IN_LOGS = 60.0  # s between words on how far it is, where nobody looks at a terminal


def main(argv: list[str] | None = None) -> None:
    """Drive trials, two at a time; exit status 1 if any fails."""
    parser = argparse.ArgumentParser(
        prog="campaign.sh", description="Faults of all kinds, drawn by seed, and what came of them."
    )
    parser.add_argument("--count", type=int, default=1000, help="trials, default 1000")
    parser.add_argument(
        "--seed", type=int, default=1, help="of the first trial, default 1; each has one more"
    )
    parser.add_argument("--minutes", type=float, help="begin no trial after so many")
    parser.add_argument("--only", type=int, nargs="+", metavar="SEED", help="repeat just these")
    parser.add_argument(
        "--page",
        type=Path,
        help="write the table into its part of this page, as docs/campaign.md has them",
    )
    parser.add_argument(
        "--keep",
        type=Path,
        metavar="DIR",
        help="keep what failed runs leave behind and say in this folder",
    )
    given = parser.parse_args(argv)
    seeds = given.only or range(given.seed, given.seed + given.count)
    part = part_of(seeds[0])
    if given.page and f"generated: {part} " not in given.page.read_text(encoding="utf-8"):
        parser.error(f"--page: {given.page} has no part 'generated: {part}' for the table")
    start = time.monotonic()
    verdicts = campaign(
        seeds, None if given.minutes is None else start + 60 * given.minutes, given.keep
    )
    text = result_text(verdicts, seeds[0], len(seeds), time.monotonic() - start)
    print(text)
    if given.page:
        given.page.write_text(
            with_blocks(given.page.read_text(encoding="utf-8"), {part: text}), encoding="utf-8"
        )
    sys.exit(any(verdict.outcome == FAILED for verdict in verdicts))


def campaign(seeds: Sequence[int], deadline: float | None, keep: Path | None) -> list[Verdict]:
    """The verdicts of all trials that were begun before the deadline."""
    bar = tqdm(total=len(seeds), unit="trial", mininterval=0.1 if sys.stderr.isatty() else _IN_LOGS)

    def one(seed: int) -> Verdict | None:
        if deadline is not None and time.monotonic() > deadline:
            return None
        with tempfile.TemporaryDirectory(
            prefix="ev_stack_campaign_", ignore_cleanup_errors=True
        ) as folder:
            verdict = driven(seed, Path(folder), keep)
        bar.update()
        if verdict.outcome == FAILED:
            tqdm.write(line_of(verdict), file=sys.stderr)
        return verdict

    with ThreadPoolExecutor(_AT_ONCE) as pool:
        verdicts = [verdict for verdict in pool.map(one, seeds) if verdict is not None]
    bar.close()
    return verdicts


def driven(seed: int, folder: Path, keep: Path | None) -> Verdict:
    """One trial from beginning to end; whatever goes wrong in the campaign itself counts as a failure."""
    kind = kind_of(seed)
    trial = begun(seed, kind.name, kind.ways, folder)
    trial.turn = turn_of(seed)
    run = None
    try:
        with trial.clean_up:
            kind.fill_in(trial)
            memory = shared_memory()
            run = UnderWay(trial)
            try:
                trial.disturb(run)
                status = run.end(AFTER_STRIKE if run.struck and trial.must_end else PATIENCE)
                ended = time.monotonic()
                if status is None and keep is not None:
                    keep_stacks(run.processes(), folder)
                outcome, remark = judged(run, status)
                if outcome != FAILED:
                    found = [run.remark] if run.remark else list(left_behind(run, memory))
                    outcome, remark = (FAILED, "; ".join(found)) if found else (outcome, remark)
            finally:
                run.sweep()
            verdict = Verdict(trial, outcome, remark, run.struck, ended - run.struck_at)
            if outcome == FAILED and keep is not None:
                shutil.copytree(folder, keep / str(seed), dirs_exist_ok=True)
            return verdict
    except Skipped as reason:
        return Verdict(trial, SKIPPED, str(reason))
    except Exception:
        return Verdict(trial, FAILED, f"the campaign itself: {traceback.format_exc()}")


def line_of(verdict: Verdict) -> str:
    """One line on a failure, with the command that repeats it."""
    trial = verdict.trial
    where = f"{trial.kind} ({trial.about}), {trial.scenario} {trial.duration:g} s, {trial.way}"
    return (
        f"FAILURE {trial.seed}: {where}: {verdict.remark}; repeat: scripts/campaign.sh --only"
        f" {trial.seed}"
    )


if __name__ == "__main__":
    main()
