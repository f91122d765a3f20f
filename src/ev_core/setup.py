"""Build and install ev_core."""

from xml.etree import ElementTree

from setuptools import find_packages, setup

PACKAGE = ElementTree.parse("package.xml").getroot()
VERSION = PACKAGE.findtext("version")

setup(
    name="ev_core",
    version=VERSION,
    description=PACKAGE.findtext("description"),
    maintainer=PACKAGE.findtext("maintainer"),
    maintainer_email=PACKAGE.find("maintainer").get("email"),
    license=PACKAGE.findtext("license"),
    packages=find_packages(exclude=["test"]),
    package_data={"ev_core": ["py.typed"]},
    data_files=[
        ("share/ament_index/resource_index/packages", ["resource/ev_core"]),
        ("share/ev_core", ["package.xml"]),
    ],
    python_requires=">=3.11",
    install_requires=[
        f"ev_msgs_py=={VERSION}",
        "numba==0.68.*",  # and with it llvmlite: its version decides the last bit of a result
        "numpy>=1.26.4",
    ],
    extras_require={"test": ["pytest"]},
    zip_safe=True,
)
