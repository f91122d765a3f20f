"""Build and install ev_sim."""

from pathlib import Path

from setuptools import find_packages, setup


def config_files() -> list[tuple[str, list[str]]]:
    """Every folder of config/ (a link to the one at the top of the repository) with its files."""
    folders = [Path("config"), *sorted(path for path in Path("config").rglob("*") if path.is_dir())]
    return [
        (f"share/ev_sim/{folder}", [str(path) for path in sorted(folder.iterdir()) if path.is_file()])
        for folder in folders
    ]


setup(
    name="ev_sim",
    version="0.1.0",
    description="The world around the control laws: plant, steering column, driver, recorder, scenarios.",
    maintainer="EV Control Stack maintainers",
    maintainer_email="maintainers@ev-control-stack.org",
    license="Apache-2.0",
    packages=find_packages(exclude=["test"]),
    package_data={"ev_sim.report.page": ["templates/*", "vendor/*"]},
    data_files=[
        ("share/ament_index/resource_index/packages", ["resource/ev_sim"]),
        ("share/ament_index/resource_index/ev_stack_config", ["resource/ev_sim"]),
        ("share/ev_sim", ["package.xml"]),
        *config_files(),
    ],
    install_requires=["setuptools"],
    extras_require={"test": ["pytest"]},
    zip_safe=True,
    entry_points={
        "console_scripts": [
            "plant = ev_sim.nodes.plant:main",
            "steering_column = ev_sim.nodes.steering_column:main",
            "driver = ev_sim.nodes.driver:main",
            "recorder = ev_sim.nodes.recorder:main",
            "inverter = ev_sim.nodes.inverter:main",
            "can_hub = ev_sim.commands.can_hub:main",
            "run_scenario = ev_sim.commands.run_scenario:main",
            "security_policies = ev_sim.commands.security_policies:main",
            "inspect = ev_sim.commands.inspect_graph:main",
        ],
        "ev_stack.methods": [
            "plant = ev_sim.methods.plant",
            "steering_column = ev_sim.methods.steering_column",
            "driver = ev_sim.methods.driver",
        ],
    },
)
