"""The sources: what each of them published and how that is judged, as its published.csv lists it.

How it works: a source is a module of a package, found by an entry point, with a published.csv
beside it. Rows are read and put together by id without importing the module, so that numbers can be
looked up cheaply; `published` imports it for its measures and makes a `Published` of each id. Short
texts of texts.csv stand in braces in the cells.
"""

from __future__ import annotations

import csv
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType

from ev_core.methods.offered import offered, offered_module
from ev_core.parameters.data_file import TEXT, read_data
from ev_msgs_py.refusal import ParameterError, quoted
from ev_stack.measures.metric import Band, Metric, Reference
from ev_study.verdicts.check import Check, check_of
from ev_study.verdicts.measure import COMMON, EMPTY, Measures, Template
from ev_study.verdicts.need import Driven, Need, need_of

GROUP = "ev_stack.sources"  # of entry points: the name of a source, and its module
KINDS = ("printed", "follows", "words", "axes", "lost")
ASSUMPTION, FITTED, INPUTS, IN_PART = "assumption", "fitted", "inputs", "in part"
NO_VERDICT = ("not judgeable", "no verdict")
WITH_ADDITION = (ASSUMPTION, FITTED, IN_PART)  # notes that name what was added to the source
NOTES = (*WITH_ADDITION, INPUTS, *NO_VERDICT)
# Of an id further rows have its further numbers, and nothing in the columns up to printed. What is
# driven stands in its first row, or in each where that differs; the note stands in one of them.
COLUMNS = (
    *("id", "kind", "where", "quantity", "printed", "driven", "note"),
    *("name", "measure", "unit", "value", "tolerance", "why"),
)
_CELLS_OF_ID = COLUMNS[1:5]


@cache
def sources() -> dict[str, ModuleType]:
    """The module of each source by name, in their `ORDER`.

    It has PANELS (its figures), published.csv beside it and, for what no expression measures, the
    functions MEASURES.
    """
    found = {name: source_named(name) for name in offered(GROUP)}
    return dict(sorted(found.items(), key=lambda each: (each[1].ORDER, each[0])))


def source_named(name: str) -> ModuleType:
    """The module of a source, and of no other.

    Raises ParameterError that lists the known ones if there is none.
    """
    return offered_module(GROUP, "source", name)


@dataclass(frozen=True, slots=True)
class Published:
    """A number, curve or claim of a source, and how it is judged.

    `kind`: printed (stands in the source), follows (not printed, but follows from printed equations
    and parameters alone), words (stated in words), axes (the range of an axis is left), lost (a
    curve of which only the caption is left). `where`: equation, axes or panel. `quantity` and
    `printed` are what was published, in words and numbers. `needs`: what is driven, none for what
    follows from equations alone; `checks`: the numbers. `note`: what had to be added to the source
    (assumption), or fitted to what it published (fitted), why the number cannot fail by physics, because it comes from the inputs of the run
    (inputs), which part of it holds where its first number, as the source defines it, does not (in
    part), or why there is no verdict (not judgeable, no verdict), with the needs of what is filled
    into its text; empty if there is none.
    """

    id: str
    kind: str
    where: str
    quantity: str
    printed: str
    needs: tuple[Need, ...] = ()
    checks: tuple[Check, ...] = ()
    note: str = ""
    text: Template = EMPTY
    text_needs: tuple[Need, ...] = ()

    @property
    def is_judged(self) -> bool:
        """True if there is a verdict; numbers are shown also without one."""
        return self.note not in NO_VERDICT

    def noted(self, driven: Mapping[Need, Driven]) -> str:
        """The text of the note, with what was driven for it filled in."""
        return self.text.filled([driven[need] for need in self.text_needs])

    def metrics(self, driven: Mapping[Need, Driven]) -> dict[str, Metric]:
        """The numbers of this id by name of the check."""
        note = self.noted(driven)
        assumption = note if self.note in WITH_ADDITION else ""
        inputs = note if self.note == INPUTS else ""

        def reference(value: float, band: Band, compared: str) -> Reference:
            source = f"{self.kind}{': ' if self.where else ''}{self.where}{compared}"
            return Reference(value, band, source, assumption, inputs)

        # A number of an id without a verdict is shown all the same, but not held against anything.
        found = {
            of.name: of.metric(reference, [driven[need] for need in of.needs]) for of in self.checks
        }
        return (
            found
            if self.is_judged
            else {name: replace(each, reference=None) for name, each in found.items()}
        )


_Row = Mapping[str, str]  # text by column, and in `place` file and line


@cache
def published(source: str) -> dict[str, Published]:
    """Everything that a source published by id, in the order of its list.

    Raises ParameterError, in one line with file, line and id, if something of a row is refused.
    """
    measures = {**COMMON, **getattr(source_named(source), "MEASURES", {})}
    return {id: _published(id, rows, measures) for id, rows in _rows_by_id(source).items()}


def published_value(source: str, id: str, name: str = "") -> float:
    """The value of one of the numbers of an id; the list is read without what measures."""
    return next(float(row["value"]) for row in _rows_by_id(source)[id] if row["name"] == name)


def _published(id: str, rows: list[_Row], measures: Measures) -> Published:
    first, needs, checks = rows[0], [], []
    entry = Published(id, *(first[name] for name in _CELLS_OF_ID))
    of_row: tuple[Need, ...] = ()
    try:
        for row in rows:
            place = row["place"]
            of_row = (
                tuple(need_of(each) for each in row["driven"].split(";"))
                if row["driven"]
                else of_row
            )
            # What is driven stands in the first row of an id, and holds for the next ones until
            # another is given.
            needs += of_row
            if row["measure"]:
                checks.append(check_of(row, measures, of_row))
            # A row without a measure may only have a note.
            elif any(row[name] for name in COLUMNS[7:]):
                raise ParameterError(
                    "the measure is missing, expected its name with the words that it takes"
                )
            if row["note"]:
                note, _, text = row["note"].partition(": ")
                if note not in NOTES or not text or entry.note:
                    refused = "a second note" if entry.note else f"the note {quoted(row['note'])}"
                    raise ParameterError(
                        f"{refused} is refused, expected one that begins with"
                        f" {': , '.join(NOTES)}: "
                    )
                # A note may need what is driven in its own row.
                entry = replace(
                    entry, note=note, text=Template.of(text, measures, of_row), text_needs=of_row
                )
        place = first["place"]
        if entry.kind not in KINDS:
            raise ParameterError(
                f"kind {quoted(entry.kind)} is refused, expected {', '.join(KINDS)}"
            )
        if len({check.name for check in checks}) < len(checks):
            raise ParameterError("two of its numbers have one name, expected one each")
        if entry.is_judged and not checks:
            raise ParameterError(
                "nothing is measured, expected that with a note why there is no verdict"
            )
    except ParameterError as error:
        raise ParameterError(f"{place}: {error}") from None
    return replace(entry, needs=tuple(dict.fromkeys(needs)), checks=tuple(checks))


@cache
def _rows_by_id(source: str) -> dict[str, list[_Row]]:
    # The folder without the module, which reads it.
    path = Path(find_spec(offered(GROUP)[source]).origin).with_name("published.csv")
    texts: dict[str, str] = {}
    if (short := path.with_name("texts.csv")).is_file():
        for _, (name, text) in _lines(short, ("name", "text")):
            # A short text may use those above it, not those below.
            texts[name] = _expanded(text, texts)
    found: dict[str, list[_Row]] = {}
    id = ""
    for line, cells in _lines(path, COLUMNS):
        row = {name: _expanded(cell, texts) for name, cell in zip(COLUMNS, cells, strict=True)}
        # A row without id belongs to the one above.
        id = row["id"] or id
        row["place"] = f"{path}, line {line}, {id or 'no id'}"
        if row["id"] in found:
            raise ParameterError(f"{row['place']}: the id is listed twice, expected once")
        if row["id"]:
            found[id] = []
        elif not id or any(row[name] for name in _CELLS_OF_ID):
            raise ParameterError(
                f"{row['place']}: a row without id has {', '.join(_CELLS_OF_ID)}, expected none of"
                " them"
            )
        found[id].append(row)
    return found


def _expanded(text: str, texts: Mapping[str, str]) -> str:
    for name, meant in texts.items() if "{" in text else ():
        text = text.replace(f"{{{name}}}", meant)
    return text


def _lines(path: Path, columns: tuple[str, ...]) -> Iterator[tuple[int, list[str]]]:
    """Number and cells of each line of a file; those left out at the end of a line are empty."""
    text = read_data(path, TEXT).decode("utf-8-sig")
    # Comments become empty lines, so that the numbers of the lines stay those of the file.
    lines = csv.reader("" if line.startswith("#") else line for line in text.splitlines())
    rows = ((lines.line_num, row) for row in lines if row)
    line, header = next(rows, (1, []))
    if tuple(header) != columns:
        raise ParameterError(
            f"{path}, line {line}: the columns are refused, expected {','.join(columns)}"
        )
    for line, row in rows:
        if len(row) > len(columns):
            raise ParameterError(
                f"{path}, line {line}: {len(row)} cells, expected {len(columns)}: quote what has"
                " commas"
            )
        # The last columns of most rows are empty, and a line may leave them out.
        yield line, row + [""] * (len(columns) - len(row))
