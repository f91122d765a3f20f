"""The numbers of a page about one scenario: its metrics run by run, and what it was compared with."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from documentation.asr_seeds import seed_tables
from documentation.markdown import code, table
from documentation.measured import ROOT, is_long, read_measured, write_measured
from documentation.neutral_steer import neutral_steer_table, save_bode_plot
from documentation.results import Driven
from ev_papers.ge_ni2005.source import CASES
from ev_stack.measures.metric import Metric
from ev_study.studies.run_study import arguments, figures_of
from ev_study.studies.study import Results, study_named
from ev_study.verdicts.need import StudyNeed, drive, kept_by_user
from ev_study.verdicts.sources import published


@dataclass(frozen=True, slots=True)
class Page:
    """Whose results a page shows: one table for each group of names with which metrics end, and figures.

    `studies` are those whose tables stand on the page as parts of their names, `tables` make
    further parts, and `images` draw into a folder. Judged numbers whose names end with one of the
    `cases` stand side by side, each case (its ending and its heading) in a column.
    """

    scenario: str
    columns: tuple[tuple[str, ...], ...]
    figures: tuple[str, ...]
    studies: tuple[str, ...] = ()
    tables: Mapping[str, Callable[[], str]] = field(default_factory=dict)
    images: tuple[Callable[[Path], None], ...] = ()
    cases: tuple[tuple[str, str], ...] = ()


def drive_study(name: str, root: Path | None, *options: str) -> Results:
    """All cases of a study; of a long one the numbers are kept beside the page, below the root of the repository."""
    from ev_study.studies.driving import drive_cases

    need = StudyNeed(name, options)
    cases = drive([need], kept_by_user(), drive_cases)[need]
    if root and is_long(need):
        write_measured(root, need, cases)
    return cases.results


def sums_table(name: str, results: Results, *options: str) -> str:
    """What the rows of a study add up to; empty if it sums nothing up."""
    study, given = study_named(name), arguments(name, options)
    found = study.metrics(given, results).items()
    sums = [
        (code(key), _number(metric), metric.unit)
        for key, metric in found
        if key.startswith(getattr(study, "SUMS", ()))
    ]
    return table(("metric", "value", "unit"), sums) if sums else ""


def engine_sweep_table() -> str:
    """What the sweep of docs/zhileykin2018.md adds up to with an engine."""
    name, *options = _ENGINE_SWEEP
    return sums_table(name, drive_study(name, None, *options), *options)


_ENGINE_SWEEP = ("zhileykin2018_sweep", "--drive", "engine")
_CONTROLS = ("equal_torque", "rate", "offset", "increment")
SCENARIO_PAGES = {
    "docs/ge_ni2005.md": Page(
        "ge_ni2005",
        (
            (*_CONTROLS, "increment_estimated", "equal_torque_rear_steered", "rate_rear_steered"),
            *(tuple(f"{name}{case}" for name in _CONTROLS) for case in CASES if case),
            tuple(f"{name}_switched" for name in _CONTROLS[1:]),
            tuple(
                f"{name}_lower_target{layer}"
                for name in _CONTROLS[1:3]
                for layer in ("", "_switched")
            ),
        ),
        ("fig3_fig4", "fig3_fig4_free_speed", "boundary_layer"),
        studies=("ge_ni2005_periods",),
        cases=tuple(
            zip(
                CASES,
                ("the source's car, u held", "u free", "full car, u held", "full car, u free"),
                strict=True,
            )
        ),
    ),
    "docs/tatar_chudzik.md": Page(
        "tatar_chudzik",
        (
            tuple(
                f"{layout}_{control}"
                for layout in ("front", "rear", "all")
                for control in ("equal", "corrected")
            ),
        ),
        ("forces_y", "fig3_to_fig11", "fig12_to_fig14"),
        cases=(
            *(
                (f".{check.name.replace(' ', '_')}", check.name)
                # as all signs: at some speeds
                for check in published("tatar_chudzik")["tatar.fig12.FL"].checks
                if check.is_judged
            ),
            ("", "at 8.5 m/s alone"),
        ),
    ),
    "docs/zhileykin2018.md": Page(
        "zhileykin2018",
        (("rear_drive", "k05", "k1", "k1_estimated", "equality", "fixed_split"),),
        ("fig3_fig4", "fig5"),
        studies=("zhileykin2018_sweep", "zhileykin2018_variants", "zhileykin2018_steering"),
        tables={"neutral steer": neutral_steer_table},
        images=(save_bode_plot,),
    ),
}

STUDY_PAGES = {  # pages that show studies alone
    "docs/asr.md": ("asr_shootout",),
    "docs/beyond.md": ("shchur2019_course", "ge_ni2005_wheel_speeds"),
    "docs/braking.md": ("braking",),
    "docs/faults.md": ("faults",),
    "docs/outside_checks.md": ("outside_friction", "outside_laws", "outside_lap"),
    "docs/dissertation.md": ("five_methods", "urban_sensitivity"),
}
LONG_TABLES = {  # by page the studies of which only the built page has the tables
    "docs/asr.md": ("asr_shootout",),
    "docs/beyond.md": ("shchur2019_course", "ge_ni2005_wheel_speeds"),
    "docs/faults.md": ("faults",),
    "docs/outside_checks.md": ("outside_laws",),
}
# further parts
STUDY_TABLES: dict[str, dict[str, Callable[[], str]]] = {"docs/asr.md": {"seeds": seed_tables}}


def results_of(page: Page, driven: Driven) -> str:
    """The tables of a page: metrics by run, then those with a reference, with both numbers and verdict."""
    metrics = driven.metrics
    compared = _side_by_side(metrics, page.cases) if page.cases else _compared(metrics)
    return "\n".join([*_by_run(metrics, page.columns), compared])


def study_table(name: str, results: Results) -> str:
    """The rows of a study, and below them what they add up to."""
    study, sums = study_named(name), sums_table(name, results)
    rows = table(study.COLUMNS, study.rows(arguments(name, ()), results))
    return f"{rows}\n{sums}" if sums else rows


def kept_study_table(name: str) -> str:
    """The table of a long study from the numbers that the repository keeps of it."""
    return study_table(name, read_measured(ROOT, StudyNeed(name)).results)


def save_study_images(name: str, results: Results, folder: Path) -> None:
    """The figures of a study as STUDY_FIGURE.png."""
    from documentation.images import save_small

    figures = figures_of(study_named(name), arguments(name, ()), results)
    save_small({f"{name}_{key}": figure for key, figure in figures.items()}, folder)


def save_images(page: Page, driven: Driven, folder: Path) -> None:
    """The figures of a page as SCENARIO_FIGURE.png."""
    from documentation.images import save_small

    figures = driven.figures
    save_small({f"{page.scenario}_{name}": figures[name] for name in page.figures}, folder)
    for save in page.images:
        save(folder)


def _by_run(metrics: Mapping[str, Metric], columns: tuple[tuple[str, ...], ...]) -> list[str]:
    """One table for each group of columns; a metric belongs to the longest name that it ends with."""
    names = sorted((name for group in columns for name in group), key=len, reverse=True)
    cells: dict[str, dict[str, Metric]] = {}
    for key, metric in metrics.items():
        ending = next((name for name in names if key.endswith(f"_{name}")), None)
        # ids of what is judged have dots
        if ending and "." not in key and not key.startswith("claim_"):
            cells.setdefault(key.removesuffix(f"_{ending}"), {})[ending] = metric
    tables = []
    for group in columns:
        rows = [
            (
                code(quantity),
                next(iter(of.values())).unit,
                *(_number(of.get(name)) for name in group),
            )
            for quantity, of in cells.items()
            if any(name in of for name in group)
        ]
        tables.append(table(("metric", "unit", *map(code, group)), rows))
    return tables


def _compared(metrics: Mapping[str, Metric]) -> str:
    rows = [
        (
            code(name),
            f"{_number(metric)} {metric.unit}".removesuffix(" 1"),
            metric.reference.source,
            metric.verdict,
        )
        for name, metric in metrics.items()
        if metric.reference
    ]
    return table(("metric", "value", "compared with", "verdict"), rows)


def _side_by_side(metrics: Mapping[str, Metric], cases: Sequence[tuple[str, str]]) -> str:
    """One row for each judged number, one column for each case: the number and what it is worth there."""
    rows: dict[str, dict[str, str]] = {}
    for name, metric in metrics.items():
        if metric.reference:
            ending = max(
                (ending for ending, _ in cases if name.endswith(ending)), key=len, default=""
            )
            cell = f"{_number(metric)} {metric.unit}".removesuffix(" 1")
            rows.setdefault(name.removesuffix(ending), {})[ending] = f"{cell}, {metric.judgement}"
    header = ("metric", *(heading for _, heading in cases))
    return table(
        header,
        [(code(name), *(of.get(ending, "") for ending, _ in cases)) for name, of in rows.items()],
    )


def _number(metric: Metric | None) -> str:
    if metric is None:
        return ""
    return "not measured" if metric.value is None else f"{metric.value:.4g}"
