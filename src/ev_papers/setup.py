"""Build and install ev_papers; a source without its folder is not offered."""

from pathlib import Path
from xml.etree import ElementTree

from setuptools import find_packages, setup

PACKAGE = ElementTree.parse("package.xml").getroot()
VERSION = PACKAGE.findtext("version")

HERE = Path(__file__).parent
SOURCES = (
    "shchur2019",
    "ge_ni2005",
    "tatar_chudzik",
    "dissertation",
    "zhileykin2018",
    "outside_checks",
)
REPORTS = [
    "shchur2019 = ev_papers.shchur2019.source",
    "shchur2019_steps = ev_papers.shchur2019.report_steps",
    "ge_ni2005 = ev_papers.ge_ni2005.source",
    "tatar_chudzik = ev_papers.tatar_chudzik.source",
    "urban_mixed = ev_papers.dissertation.studies.report",
    "urban_mixed_bench = ev_papers.dissertation.studies.report_bench",
    "zhileykin2018 = ev_papers.zhileykin2018.source",
    "zhileykin2018_braking = ev_papers.zhileykin2018.report_claims",
    "zhileykin2018_steered = ev_papers.zhileykin2018.report_claims",
]
STUDIES = [
    "bench_convergence = ev_papers.dissertation.studies.bench_convergence",
    "bench_faults = ev_papers.dissertation.studies.bench_faults",
    "bench_difference = ev_papers.dissertation.studies.bench_difference",
    "braking = ev_papers.dissertation.studies.braking",
    "five_methods = ev_papers.dissertation.studies.five_methods",
    "ge_ni2005_periods = ev_papers.ge_ni2005.periods",
    "ge_ni2005_wheel_speeds = ev_papers.ge_ni2005.wheel_speeds",
    "outside_friction = ev_papers.outside_checks.friction",
    "outside_lap = ev_papers.outside_checks.lap",
    "outside_laws = ev_papers.outside_checks.laws",
    "shchur2019_course = ev_papers.shchur2019.course",
    "urban_sensitivity = ev_papers.dissertation.studies.urban_sensitivity",
    "zhileykin2018_steering = ev_papers.zhileykin2018.steering",
    "zhileykin2018_sweep = ev_papers.zhileykin2018.sweep",
    "zhileykin2018_variants = ev_papers.zhileykin2018.variants",
]


def there(points: list[str]) -> list[str]:
    """Entry points with modules in this folder."""
    modules = [HERE / point.partition(" = ")[2].replace(".", "/") for point in points]
    return [
        point
        for point, module in zip(points, modules, strict=True)
        if module.with_suffix(".py").is_file()
    ]


setup(
    name="ev_papers",
    version=VERSION,
    description=PACKAGE.findtext("description"),
    maintainer=PACKAGE.findtext("maintainer"),
    maintainer_email=PACKAGE.find("maintainer").get("email"),
    license=PACKAGE.findtext("license"),
    packages=find_packages(exclude=["test"]),
    package_data={"": ["py.typed", "published.csv", "texts.csv"]},
    data_files=[
        ("share/ament_index/resource_index/packages", ["resource/ev_papers"]),
        ("share/ev_papers", ["package.xml"]),
    ],
    python_requires=">=3.11",
    install_requires=[f"ev_bench=={VERSION}", f"ev_study=={VERSION}"],
    extras_require={"test": ["pytest"]},
    zip_safe=False,  # published.csv is read as a file
    entry_points={
        "ev_stack.sources": there([f"{source} = ev_papers.{source}.source" for source in SOURCES]),
        "ev_stack.reports": there(REPORTS),
        "ev_stack.studies": there(STUDIES),
    },
)
