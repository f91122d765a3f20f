"""Build and install ev_stack."""

import sys
from xml.etree import ElementTree

from setuptools import find_packages, setup

PACKAGE = ElementTree.parse("package.xml").getroot()
VERSION = PACKAGE.findtext("version")

# What `ros2 run` starts is put into lib/ev_stack by colcon; a wheel would put it on the PATH, under
# these bare names.
NODES = ["recorder = ev_stack.recorder_node:main"]
MANOEUVRES = (
    "coast_down",
    "double_lane_change",
    "hill_start",
    "lap",
    "launch_split_mu",
    "sine_with_dwell",
    "steady_circle",
    "step_steer",
    "straight_brake_split_mu",
)
IS_COLCON = not {"install", "develop"}.isdisjoint(sys.argv)

setup(
    name="ev_stack",
    version=VERSION,
    description=PACKAGE.findtext("description"),
    maintainer=PACKAGE.findtext("maintainer"),
    maintainer_email=PACKAGE.find("maintainer").get("email"),
    license=PACKAGE.findtext("license"),
    packages=find_packages(exclude=["test"]),
    package_data={
        "ev_stack": ["py.typed", "__init__.pyi"],
        "ev_stack.figures": ["*.mplstyle"],
        "ev_stack.report.page": ["templates/*", "vendor/*"],
    },
    data_files=[
        ("share/ament_index/resource_index/packages", ["resource/ev_stack"]),
        ("share/ev_stack", ["package.xml"]),
        ("share/ev_stack/launch", ["launch/scenario.launch.py"]),
    ],
    python_requires=">=3.11",
    install_requires=[
        f"ev_control=={VERSION}",
        f"ev_sim=={VERSION}",
        "Jinja2>=3.1",
        "matplotlib>=3.9",
        "numpy>=1.26.4",
        "PyYAML>=6.0",
        "scipy>=1.13",
        "tqdm>=4.66",
    ],
    extras_require={
        "bag": ["rosbags==0.11.*"],
        "frame": ["pandas"],
        "parquet": ["pyarrow"],
        "test": ["pytest"],
    },
    zip_safe=False,  # templates are read as files
    entry_points={
        "console_scripts": [
            "ev-stack = ev_stack.commands.program:main",
            *(NODES if IS_COLCON else []),
        ],
        "ev_stack.commands": ["ev_stack = ev_stack.commands"],
        "ev_stack.nodes": NODES,
        "ev_stack.reports": [f"{name} = ev_stack.manoeuvres.{name}" for name in MANOEUVRES],
    },
)
