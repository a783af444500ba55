"""Units of the page's modules, in Node: plans, floors, turns. The browser drives the rest."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

from chord_usd.faces import page

TESTS = Path(__file__).parents[1] / "page" / "modules.test.mjs"
STATIC = Path(page.__file__).parent / "static"

THREE = "export const THREE = {};\nexport class GLTFLoader {}\n"
"""In place of three.js, which the server takes from another package."""


@pytest.mark.skipif(not shutil.which("node"), reason="there is no node: apt-get install nodejs")
def test_modules_of_the_page(tmp_path: Path) -> None:
    shutil.copytree(STATIC, tmp_path / "static")
    (tmp_path / "static" / "three.js").write_text(THREE)
    (tmp_path / "package.json").write_text('{"type": "module"}')
    shutil.copy(TESTS, tmp_path)
    done = subprocess.run(
        ["node", "--test", TESTS.name], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout
