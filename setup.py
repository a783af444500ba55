"""Puts what is no code inside the wheel; everything else is in pyproject.toml."""

from setuptools import find_packages, setup

SHIPPED = {
    "chord_usd._data.materials": "materials",
    "chord_usd._data.checkpoints": "checkpoints",
}

setup(
    packages=[*find_packages(include=["chord_usd*"]), *SHIPPED],
    package_dir=SHIPPED,
    package_data={
        "chord_usd": [
            "py.typed",
            "**/*.tsv",
            "**/*.schema.json",
            "library/cloth/*.npz",
            "faces/page/static/*",
            "line/image/web/*.js",
        ],
        **{name: ["**/*"] for name in SHIPPED},
    },
    include_package_data=False,
)
