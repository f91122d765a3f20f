"""Build and install ev_study."""

from xml.etree import ElementTree

from setuptools import find_packages, setup

PACKAGE = ElementTree.parse("package.xml").getroot()
VERSION = PACKAGE.findtext("version")

STUDIES = ("asr_shootout", "compare", "energy", "faults", "sweep")

setup(
    name="ev_study",
    version=VERSION,
    description=PACKAGE.findtext("description"),
    maintainer=PACKAGE.findtext("maintainer"),
    maintainer_email=PACKAGE.find("maintainer").get("email"),
    license=PACKAGE.findtext("license"),
    packages=find_packages(exclude=["test"]),
    package_data={"ev_study": ["py.typed", "__init__.pyi"]},
    data_files=[
        ("share/ament_index/resource_index/packages", ["resource/ev_study"]),
        ("share/ev_study", ["package.xml"]),
    ],
    python_requires=">=3.11",
    install_requires=[f"ev_stack=={VERSION}"],
    extras_require={
        "can": [f"ev_msgs_py[can]=={VERSION}", "python-can>=4.6.1"],
        "cluster": ["dask", "distributed"],
        "mf4": ["asammdf>=8.8"],
        "test": ["pytest"],
        "tune": ["cma>=4.4"],
    },
    entry_points={
        "ev_stack.commands": ["ev_study = ev_study.commands"],
        "ev_stack.studies": [f"{name} = ev_study.studies.{name}" for name in STUDIES],
    },
)
