"""Build and install ev_nodes."""

from xml.etree import ElementTree

from setuptools import find_packages, setup

PACKAGE = ElementTree.parse("package.xml").getroot()
VERSION = PACKAGE.findtext("version")

setup(
    name="ev_nodes",
    version=VERSION,
    description=PACKAGE.findtext("description"),
    maintainer=PACKAGE.findtext("maintainer"),
    maintainer_email=PACKAGE.find("maintainer").get("email"),
    license=PACKAGE.findtext("license"),
    packages=find_packages(exclude=["test"]),
    package_data={"ev_nodes": ["py.typed"]},
    data_files=[
        ("share/ament_index/resource_index/packages", ["resource/ev_nodes"]),
        ("share/ev_nodes", ["package.xml"]),
    ],
    python_requires=">=3.11",
    install_requires=[f"ev_core=={VERSION}"],
    extras_require={"test": ["pytest"]},
    zip_safe=True,
)
