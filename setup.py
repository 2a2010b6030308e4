"""ament_python package; `pip install '.[all]'` works as well, with ROS from PyPI."""

from pathlib import Path

from setuptools import find_packages, setup

PACKAGE = "winch_friction"
SHARE = f"share/{PACKAGE}"


def tree(folder: str) -> list[tuple[str, list[str]]]:
    """Data files of a folder and its subfolders, for share/."""
    folders = [path for path in (Path(folder), *Path(folder).rglob("*")) if path.is_dir()]
    return [(f"{SHARE}/{each}", [str(f) for f in each.iterdir() if f.is_file()]) for each in folders]


IDENTIFICATION = [
    "pint>=0.19",
    "pandas>=2.1",
    "pyarrow>=14",
    "matplotlib>=3.6",
    "jinja2>=3.1",
    "jsonschema>=4.10",
    "plotly>=5.18",
    "latex2mathml>=3.77",
]
EXTRAS = {
    "ros": [
        "ros-rclpy[fastrtps]==7.1.6",
        "ros-std-msgs==5.3.6",
        "ros-sensor-msgs==5.3.6",
        "ros-diagnostic-msgs==5.3.6",
        "ros-std-srvs==5.3.6",
        "ros-geometry-msgs==5.3.6",
    ],
    "desk": [
        *IDENTIFICATION,
        "numba>=0.58",
        "pydantic>=1.10",
        "rosbags>=0.9",
        "scikit-learn>=1.4",
        "statsmodels>=0.14",
        "arch>=6",
        "typer>=0.9",
        "rich>=13",
    ],
    "bench": ["pysindy>=2"],  # what naming is compared with; not in 'all': it needs numpy 2
    "xarray": ["xarray>=2023.6"],
    "fleet": ["dask[distributed]>=2024.1", "fsspec>=2024.2", "s3fs>=2024.2"],
    "import": [
        "pint>=0.19",
        "pyarrow>=14",
        "openpyxl>=3.1",
        "python-calamine>=0.2",
        "h5py>=3.8",
        "npTDMS>=1.7",
        "asammdf>=7.4",
        "typer>=0.9",
        "rich>=13",
    ],
    "fmu": ["fmpy>=0.3.20"],
    "foxglove": ["foxglove-sdk>=0.30,<1"],
    "docs": ["sphinx>=8", "furo>=2024.8", "myst-nb>=1.2"],
    "test": [
        "pytest>=7.4",
        "pytest-timeout>=2.2",
        "pytest-xdist>=3.4",
        "pytest-rerunfailures>=12",
        "hypothesis>=6.98",
        "pytest-benchmark>=4",
        "moto[s3]>=5",
        "pythonfmu>=0.6",
        "flask>=3",
        "flask-cors>=5",
        "import-linter>=2",
        "mcap-ros2-support>=0.5",
        "websockets>=12",
        "jsonschema>=4",
        "playwright>=1.49",
        "ruff==0.17.6",
        "mypy==2.4.1",
        "colcon-common-extensions>=0.3",
        "ros-ament-flake8>=0.17.3",  # these two do not say themselves what they need: the next two
        "ros-ament-pep257>=0.17.3",
        "flake8>=7",
        "pydocstyle>=6.3",
        "ament-xmllint>=0.14.2",
        "catkin-pkg>=1",
    ],
}
EXTRAS["all"] = [
    requirement
    for extra in ("desk", "import", "fmu", "foxglove", "xarray", "ros", "fleet", "docs", "test")
    for requirement in EXTRAS[extra]
]

setup(
    name=PACKAGE,
    version="0.1.0",
    packages=find_packages(include=[PACKAGE, f"{PACKAGE}.*"]),
    package_data={PACKAGE: ["py.typed", "*.pyi", "**/*.yaml", "**/*.html", "**/*.j2", "**/*.css", "**/*.js"]},
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{PACKAGE}"]),
        (SHARE, ["package.xml"]),
        *tree("launch"),
        *tree("config"),
    ],
    python_requires=">=3.11",
    install_requires=["setuptools", "numpy>=1.26", "scipy>=1.11", "sympy>=1.12", "filterpy>=1.4.5", "pyyaml>=6.0"],
    extras_require=EXTRAS,
    zip_safe=False,
    maintainer="Seed f077614b maintainers",
    maintainer_email="maintainers@users.noreply.h-seed-f077614b.example",
    description="Friction of a hydraulic winch: compensated and learned online, identified offline, questioned always.",
    license="Apache-2.0",
    entry_points={
        "console_scripts": [
            "winch-friction = winch_friction.cli.entry:main",
            "compensator = winch_friction.nodes.compensator:main",
            "estimator = winch_friction.nodes.estimator:main",
            "simulator = winch_friction.nodes.simulator:main",
        ]
    },
)
