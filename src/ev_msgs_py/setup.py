"""Build and install ev_msgs_py."""

from xml.etree import ElementTree

from setuptools import find_packages, setup

PACKAGE = ElementTree.parse("package.xml").getroot()
VERSION = PACKAGE.findtext("version")

setup(
    name="ev_msgs_py",
    version=VERSION,
    description=PACKAGE.findtext("description"),
    maintainer=PACKAGE.findtext("maintainer"),
    maintainer_email=PACKAGE.find("maintainer").get("email"),
    license=PACKAGE.findtext("license"),
    packages=find_packages(exclude=["test"]),
    package_data={"ev_msgs_py": ["py.typed"]},
    data_files=[
        ("share/ament_index/resource_index/packages", ["resource/ev_msgs_py"]),
        ("share/ev_msgs_py", ["package.xml"]),
    ],
    python_requires=">=3.11",
    install_requires=["numpy>=1.26.4"],
    extras_require={"can": ["cantools>=45.1"], "test": ["pytest"]},
    zip_safe=True,
)
