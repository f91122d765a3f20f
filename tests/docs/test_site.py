"""The pages whole, and as a site.

All tables, titles in place of file names, a reference, nothing from the network.
"""

import re
import subprocess
from pathlib import Path
from pkgutil import resolve_name

import pytest

from documentation.full_board import kept as kept_board
from documentation.markdown import built_names
from documentation.pages import BUILT
from documentation.scenario_results import LONG_TABLES, kept_study_table
from documentation.site import gather, titled
from ev_study.verdicts.sources import published, sources

ROOT = Path(__file__).parents[2]
ENVIRONMENT = ROOT / "build" / "site_environment" / ".complete"
LOADED = re.compile(
    r"<(?:script|link|img|iframe|source|object|embed)\b[^>]*?\b(?:src|href|data)=[\"']?(?:https?:)?//[^>]*>"
)
STYLED = re.compile(r"(?:url\([\"']?|@import\s+[\"'])(?:https?:)?//[^)\"']*")


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        (
            "see [lockstep.md](lockstep.md#a-b), [the page](lockstep.md)",
            "see [Lockstep](lockstep.md#a-b), [the page](lockstep.md)",
        ),
        ("a law (docs/lockstep.md).", "a law ([Lockstep](lockstep.md))."),
        (
            "`scripts/document.sh --runs docs/lockstep.md`",
            "`scripts/document.sh --runs docs/lockstep.md`",
        ),
        ("```bash\ncat docs/lockstep.md\n```", "```bash\ncat docs/lockstep.md\n```"),
        ("docs/nowhere.md", "docs/nowhere.md"),
    ],
)
def test_a_link_by_the_name_of_a_file_gets_the_title_of_the_page(text: str, shown: str):
    assert titled(text, {"lockstep.md": "Lockstep"}) == shown


@pytest.fixture(scope="module")
def pages(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("site") / "pages"
    gather(ROOT, folder)
    return folder


@pytest.mark.weekly
def test_no_link_of_a_page_has_the_name_of_a_file_as_its_text(pages: Path):
    texts = {page.name: page.read_text() for page in pages.glob("*.md")}
    assert {"index.md", "changelog.md", "reporting.md", "reference.md"} < {*texts}
    assert [
        name for name, text in texts.items() if re.search(r"\[[\w/.]+\.md\]\(\w+\.md", text)
    ] == []


def rows(page: Path, marks: str) -> list[str]:
    """The first cells of the rows of a page that have such a text as code."""
    return re.findall(rf"^\| `({marks})` \|", page.read_text(), re.MULTILINE)


@pytest.mark.weekly
def test_a_built_page_has_all_tables_that_the_repository_does_not_keep(pages: Path):
    """Each with a row for everything that it is about.

    No mark is left, nor the line in its place.
    """
    left = [page.name for page in pages.glob("*.md") if built_names(page.read_text())]
    assert left == [] and sum(len(parts) for parts in BUILT.values()) > 25
    for name, parts in BUILT.items():
        kept = (ROOT / name).read_text()
        assert built_names(kept) == list(parts)
        assert (
            "built pages](installing.md"
            not in (pages / Path(name).name).read_text().partition("\n## ")[2]
        )
    ids = [id for source in sources() for id in published(source)]
    assert rows(pages / "verdicts.md", r"[a-z]+\.[\w.]+") == ids
    assert len(rows(pages / "parameters.md", r"[\w.*]+")) > 1000
    assert len(rows(pages / "benchmark_full.md", r"[\w:]+:\*:v\d+")) == len(kept_board()["cells"])
    for name, studies in LONG_TABLES.items():
        text = (pages / Path(name).name).read_text()
        assert all(kept_study_table(study) in text for study in studies)


@pytest.mark.weekly
def test_no_link_leads_out_of_the_pages(pages: Path):
    """A file of the repository that is no page is named without a link."""
    assert [
        page.name
        for page in pages.glob("*.md")
        if re.search(r"\]\((\.\./|measured/)", page.read_text())
    ] == []
    assert "`config/benchmarks/small.yaml`" in (pages / "benchmark.md").read_text()


@pytest.mark.weekly
def test_everything_that_the_reference_names_is_there(pages: Path):
    names = re.findall(r"^::: (\S+)$", (pages / "reference.md").read_text(), re.MULTILINE)
    assert {
        "ev_stack",
        "ev_core.methods.register.method",
        "ev_control.shared.torque_split.split",
    } < {*names}
    for name in names:
        assert resolve_name(name) is not None


@pytest.mark.slow
@pytest.mark.skipif(
    not ENVIRONMENT.exists(),
    reason="build/site_environment: scripts/site.sh makes it, by pip and npm",
)
def test_the_site_loads_nothing_from_the_network():
    """Scripts, styles, fonts and images; links to other places are no more than links."""
    subprocess.run([ROOT / "scripts" / "site.sh"], check=True, capture_output=True)
    site = ROOT / "build" / "site"
    pages, styles = [*site.rglob("*.html")], [*site.rglob("*.css")]
    assert len(pages) > 40 and styles
    assert [found for page in pages for found in LOADED.findall(page.read_text())] == []
    assert [found for file in (*pages, *styles) for found in STYLED.findall(file.read_text())] == []
    shown = (site / "reference.html").read_text()
    assert "Drive a scenario and give its signals" in shown and "int | None" in re.sub(
        r"<[^>]*>", "", shown
    )
