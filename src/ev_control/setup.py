"""Build and install ev_control."""

import sys
from xml.etree import ElementTree

from setuptools import find_packages, setup

PACKAGE = ElementTree.parse("package.xml").getroot()
VERSION = PACKAGE.findtext("version")

# What `ros2 run` starts is put into lib/ev_control by colcon; a wheel would put it on the PATH,
# under these bare names.
NODES = [
    "electronic_differential = ev_control.nodes:main",
    "asr = ev_control.nodes:main",
]
IS_COLCON = not {"install", "develop"}.isdisjoint(sys.argv)

setup(
    name="ev_control",
    version=VERSION,
    description=PACKAGE.findtext("description"),
    maintainer=PACKAGE.findtext("maintainer"),
    maintainer_email=PACKAGE.find("maintainer").get("email"),
    license=PACKAGE.findtext("license"),
    packages=find_packages(exclude=["test"]),
    package_data={"ev_control": ["py.typed"]},
    data_files=[
        ("share/ament_index/resource_index/packages", ["resource/ev_control"]),
        ("share/ev_control", ["package.xml"]),
    ],
    python_requires=">=3.11",
    install_requires=[f"ev_nodes=={VERSION}", "numpy>=1.26.4"],
    extras_require={"test": ["pytest"]},
    zip_safe=True,
    entry_points={
        "console_scripts": NODES if IS_COLCON else [],
        "ev_stack.estimators": ["ev_control = ev_control.estimation.on_records"],
        "ev_stack.nodes": NODES,
        "ev_stack.methods": [
            "electronic_differential = ev_control.methods.electronic_differential",
            "asr = ev_control.methods.asr",
        ],
    },
)
