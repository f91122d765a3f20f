"""Build and install ev_doors."""

from xml.etree import ElementTree

from setuptools import find_packages, setup

PACKAGE = ElementTree.parse("package.xml").getroot()
VERSION = PACKAGE.findtext("version")

setup(
    name="ev_doors",
    version=VERSION,
    description=PACKAGE.findtext("description"),
    maintainer=PACKAGE.findtext("maintainer"),
    maintainer_email=PACKAGE.find("maintainer").get("email"),
    license=PACKAGE.findtext("license"),
    packages=find_packages(exclude=["test"]),
    package_data={"ev_doors": ["py.typed"], "ev_doors.export": ["templates/*"]},
    data_files=[
        ("share/ament_index/resource_index/packages", ["resource/ev_doors"]),
        ("share/ev_doors", ["package.xml"]),
    ],
    python_requires=">=3.11",
    install_requires=[f"ev_stack=={VERSION}"],
    extras_require={
        "dashboard": ["tornado>=6.4"],
        "gymnasium": ["gymnasium>=1.0"],
        "test": ["pytest"],
    },
    zip_safe=False,  # templates are read as files
    entry_points={
        "ev_stack.commands": ["ev_doors = ev_doors.commands"],
        "ev_stack.processors": ["program = ev_doors.export.on_processor"],
    },
)
