"""Build and install ev_sim."""

import sys
from pathlib import Path
from xml.etree import ElementTree

from setuptools import find_packages, setup

PACKAGE = ElementTree.parse("package.xml").getroot()
VERSION = PACKAGE.findtext("version")

# What `ros2 run` starts is put into lib/ev_sim by colcon; a wheel would put it on the PATH, under
# these bare names.
ROLES = ("plant", "steering_column", "driver", "rear_steering")
NODES = [f"{role} = ev_sim.nodes:main" for role in ROLES]
IS_COLCON = not {"install", "develop"}.isdisjoint(sys.argv)

# ev_sim/config is a link to the folder at the top of the repository.
CONFIG = [
    str(path.relative_to("ev_sim"))
    for path in sorted(Path("ev_sim", "config").rglob("*"))
    if path.is_file()
]
if not CONFIG:
    sys.exit(
        "src/ev_sim alone lacks ev_sim/config, a link out of it: expected a checkout, or "
        "scripts/build_wheels.sh"
    )

setup(
    name="ev_sim",
    version=VERSION,
    description=PACKAGE.findtext("description"),
    maintainer=PACKAGE.findtext("maintainer"),
    maintainer_email=PACKAGE.find("maintainer").get("email"),
    license=PACKAGE.findtext("license"),
    packages=find_packages(exclude=["test"]),
    package_data={"ev_sim": ["py.typed", *CONFIG]},
    data_files=[
        ("share/ament_index/resource_index/packages", ["resource/ev_sim"]),
        ("share/ev_sim", ["package.xml"]),
    ],
    python_requires=">=3.11",
    install_requires=[
        f"ev_nodes=={VERSION}",
        "numpy>=1.26.4",
        "PyYAML>=6.0",
    ],
    extras_require={"test": ["pytest"]},
    zip_safe=False,  # config is read as files
    entry_points={
        "console_scripts": NODES if IS_COLCON else [],
        "ev_stack.nodes": NODES,
        "ev_stack.config": ["ev_sim = ev_sim"],
        "ev_stack.methods": [f"{role} = ev_sim.methods.{role}" for role in ROLES],
    },
)
