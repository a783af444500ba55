"""Files that are made to do harm are one error line, soon, within a GiB and with nothing opened."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import time
import zipfile
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import pytest
from PIL import Image

from chord_usd.line.plan.picture import LARGEST_SIDE_PX, read_picture
from chord_usd.line.plan.read import read_plan_file
from tests.every import later

LONGEST_S = 60.0
LARGEST_MIB = 1024 + 128
"""The limit, and what an interpreter with numpy starts with."""

READ = """
import resource, subprocess, sys
code = subprocess.run([sys.executable, "-m", "chord_usd.cli", "plan", "read", *sys.argv[1:]])
print(code.returncode, resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss // 1024)
"""
"""Tells the exit code and the peak of the largest process, in MiB."""


# PDF ----------------------------------------------------------------------------------------------


def write_pdf(path: Path, content: str, page: str = "0 0 600 800", *more: str) -> None:
    """One page; further objects from number 5 on, of which the first is its form /X."""
    bodies = [
        "<< /Type /Catalog /Pages 2 0 R >>",
        "<< /Type /Pages /Kids [3 0 R] /Count 1 >>",
        f"<< /Type /Page /Parent 2 0 R /MediaBox [{page}] /Contents 4 0 R {FORMS} >>",
        f"<< /Length {len(content)} >>\nstream\n{content}\nendstream",
        *more,
    ]
    parts = [f"{number} 0 obj\n{body}\nendobj\n" for number, body in enumerate(bodies, 1)]
    # Without a table of its objects, which every reader makes anew where it is missing.
    path.write_text("%PDF-1.7\n" + "".join(parts) + "trailer << /Root 1 0 R >>\n%%EOF\n")


FORMS = "/Resources << /XObject << /X 5 0 R >> >>"
SELF_DRAWING = "/X Do " * 6 + "0 0 m 100 100 l S"
FORM = (
    f"<< /Type /XObject /Subtype /Form /BBox [0 0 600 800] {FORMS} "
    f"/Length {len(SELF_DRAWING)} >>\nstream\n{SELF_DRAWING}\nendstream"
)
PASSWORD = (
    b"%PDF-1.4\n1 0 obj<</Type/Catalog/Pages 2 0 R>>endobj\n"
    b"2 0 obj<</Type/Pages/Kids[]/Count 0>>endobj\n"
    b"3 0 obj<</Filter/Standard/V 1/R 2/O<" + b"41" * 32 + b">/U<" + b"42" * 32 + b">/P -4>>"
    b"endobj\ntrailer<</Root 1 0 R/Encrypt 3 0 R/ID[<41><41>]/Size 4>>\n%%EOF"
)


# DXF ----------------------------------------------------------------------------------------------


def write_blocks(path: Path, levels: int, inserts: int, *, in_itself: bool = False) -> None:
    """Blocks of blocks of walls: inserts ** levels of them."""
    import ezdxf

    document = ezdxf.new()
    corners = [(0, 0), (5, 0), (5, 0.2), (0, 0.2)]
    wall = document.blocks.new("B0")
    wall.add_lwpolyline(corners, close=True, dxfattribs={"layer": "WALLS"})
    for level in range(1, levels + 1):
        block = document.blocks.new(f"B{level}")
        for place in range(inserts):
            block.add_blockref(f"B{level if in_itself else level - 1}", (place, 0))
    document.modelspace().add_blockref(f"B{levels}", (0, 0))
    document.saveas(path)


def write_endless_arc(path: Path) -> None:
    """A door round no centre, on which ezdxf never ends."""
    import ezdxf

    document = ezdxf.new()
    document.modelspace().add_arc((12345, 0), 900, 0, 90)
    document.saveas(path)
    path.write_text(path.read_text().replace("12345.0", "nan"))


def write_odd_number(path: Path, number: str) -> None:
    """A room of four walls, with one coordinate that is none."""
    import ezdxf

    document = ezdxf.new()
    corners = [(0, 0), (8765, 0), (8765, 5000), (0, 5000)]
    document.modelspace().add_lwpolyline(corners, close=True, dxfattribs={"layer": "WALLS"})
    document.saveas(path)
    text = path.read_text()
    assert "8765.0" in text
    path.write_text(text.replace("8765.0", number, 1))


# Sweet Home 3D ------------------------------------------------------------------------------------


def write_home(path: Path, more: str) -> None:
    ends = [(0, 0, 500, 0), (500, 0, 500, 500), (500, 500, 0, 500), (0, 500, 0, 0)]
    walls = "".join(
        f'<wall xStart="{a}" yStart="{b}" xEnd="{c}" yEnd="{d}" thickness="10"/>'
        for a, b, c, d in ends
    )
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("Home.xml", f"<home>{walls}{more}</home>")


# SVG and pictures ---------------------------------------------------------------------------------


def svg_in(encoding: str) -> str:
    return f'<?xml version="1.0" encoding="{encoding}"?><svg><rect class="room" width="5"/></svg>'


LAUGHS = (
    '<!DOCTYPE s [<!ENTITY a "ha">'
    + "".join(
        f'<!ENTITY {b} "{f"&{a};" * 9}">' for a, b in zip("abcdefgh", "bcdefghi", strict=True)
    )
    + "]><svg><text>&i;</text></svg>"
)
ZIGZAG = '<svg><path class="wall" d="M' + "12 34 56 78 " * 225_000 + '"/></svg>'


def write_strip(path: Path) -> None:
    """A picture so long that OCR would enlarge it to 200 million pixels."""
    pixels = np.full((12_000, 33, 3), 255, np.uint8)
    for top in range(0, 12_000, 40):
        cv2.rectangle(pixels, (4, top), (26, top + 22), (0, 0, 0), 2)
    Image.fromarray(pixels).save(path)


def write_eps(path: Path) -> None:
    Image.new("RGB", (400, 400)).save(path.with_suffix(".eps"))
    path.with_suffix(".eps").rename(path)


HOSTILE: dict[str, tuple[Callable[[Path], object], str]] = {
    "form in itself.pdf": (
        lambda p: write_pdf(p, "/X Do", "0 0 600 800", FORM),
        "more than 1024 MiB",
    ),
    "strokes.pdf": (lambda p: write_pdf(p, "0 0 m 9 9 l S\n" * 500_000), "line segments"),
    "strip.pdf": (lambda p: write_pdf(p, "0 0 m 9 9 l S", "0 0 1 100000"), "1 × 14400|1 × 100000"),
    "password.pdf": (lambda p: p.write_bytes(PASSWORD), "is protected by a password"),
    "bomb.dxf": (lambda p: write_blocks(p, 8, 10), "more than 300,000 entities"),
    "ring.dxf": (lambda p: write_blocks(p, 1, 10, in_itself=True), "entities|no layer|damaged"),
    "nan.dxf": (lambda p: write_odd_number(p, "nan"), "that are no numbers"),
    "inf.dxf": (lambda p: write_odd_number(p, "1e999"), "that are no numbers"),
    "arc.dxf": (write_endless_arc, "that are no numbers"),
    "1e308.dxf": (lambda p: write_odd_number(p, "1e308"), "too large"),
    "door.sh3d": (
        lambda p: write_home(p, '<doorOrWindow x="1e308" y="0" width="1e308" height="200"/>'),
        "x is 1e[+]308",
    ),
    "wall.sh3d": (
        lambda p: write_home(p, '<wall xStart="-1e308" yStart="0" xEnd="1e308" yEnd="0"/>'),
        "xStart is -1e[+]308",
    ),
    "walls.sh3d": (
        lambda p: write_home(
            p,
            "".join(
                f'<wall xStart="{x % 977}" yStart="{x % 1009}" xEnd="{x % 1013}" yEnd="4"/>'
                for x in range(390_000)
            ),
        ),
        "more than 20,000 walls",
    ),
    "laughs.svg": (lambda p: p.write_text(LAUGHS), "declares XML entities"),
    "zigzag.svg": (lambda p: p.write_text(ZIGZAG), "more than 200,000 numbers"),
    "deep.svg": (
        lambda p: p.write_text("<svg>" + "<g>" * 10_000 + "</g>" * 10_000 + "</svg>"),
        "nested too deeply",
    ),
    **{
        f"{name}.svg": (lambda p, name=name: p.write_text(svg_in(name)), f"encoding '{name}'")
        for name in ("rot13", "utf-7", "big5", "no-such")
    },
    "long.png": (lambda p: Image.new("1", (60_000, 40)).save(p), "60000×40 pixels"),
    "long.jpg": (lambda p: Image.new("L", (60_000, 40)).save(p), "60000×40 pixels"),
    "bomb.tif": (
        lambda p: Image.new("1", (40_000, 40_000)).save(p, compression="group4"),
        "is too large",
    ),
    "strip.png": (write_strip, "no closed room"),
    "eps.png": (write_eps, "is not a picture"),
}


@pytest.mark.parametrize("name", HOSTILE)
def test_hostile_files_are_one_error_line_soon_and_within_a_gib(name: str, tmp_path: Path) -> None:
    make, message = HOSTILE[name]
    path = tmp_path / name
    make(path)
    began = time.monotonic()
    done = subprocess.run(
        [sys.executable, "-c", READ, path, "-o", tmp_path / "plan.json"],
        capture_output=True, text=True, check=True, timeout=2 * LONGEST_S,
    )  # fmt: skip
    seconds = time.monotonic() - began
    code, peak_mib = map(int, done.stdout.split())
    lines = done.stderr.splitlines()
    assert (code, len(lines)) == (2, 1), done.stderr
    assert lines[0].startswith(f"error: {path}: ")
    assert "unexpected" not in lines[0]
    assert re.search(message, lines[0]), lines[0]
    assert seconds < LONGEST_S
    assert peak_mib < LARGEST_MIB
    assert sorted(file.name for file in tmp_path.iterdir()) == [name]


@pytest.mark.parametrize("mode", ["RGBA", *later("I;16")])
def test_the_largest_pictures_that_are_promised_fit_the_limit(mode: str, tmp_path: Path) -> None:
    side = LARGEST_SIDE_PX
    Image.new(mode, (side, side)).save(tmp_path / "plan.png", compress_level=1)
    picture = read_picture(tmp_path / "plan.png")
    assert picture.rgb.shape == (side, side, 3)
    # Clear is paper, and the least grey is black.
    assert picture.rgb[0, 0, 0] == picture.rgb[-1, -1, -1] == (255 if mode == "RGBA" else 0)


@pytest.mark.alone
@pytest.mark.parametrize(("number", "code"), [(signal.SIGTERM, 143), (signal.SIGINT, 130)])
def test_a_reading_that_lasts_is_ended_at_once(
    number: signal.Signals, code: int, tmp_path: Path
) -> None:
    write_blocks(tmp_path / "plan.dxf", 5, 10)
    command = [sys.executable, "-m", "chord_usd.cli", "plan", "read", "plan.dxf", "-o", "plan.json"]
    with subprocess.Popen(command, cwd=tmp_path, stderr=subprocess.PIPE) as process:
        time.sleep(2.0)
        assert process.poll() is None
        began = time.monotonic()
        process.send_signal(number)
        assert process.wait(10) == code
        assert time.monotonic() - began < 2.0
    assert [file.name for file in tmp_path.iterdir()] == ["plan.dxf"]


REFERENCES = (
    '<image href="{0}" width="5" height="5"/>'
    '<image xlink:href="file://{0}"/>'
    '<use href="{0}#a"/>'
    '<style>@import url("{0}");</style>'
    '<rect class="wall" fill="url({0}#a)" width="0" height="0"/>'
)


def test_no_file_that_an_svg_names_is_opened(tmp_path: Path) -> None:
    # Whoever opens a pipe waits until somebody writes to it.
    os.mkfifo(tmp_path / "pipe")
    sheet = f'<?xml-stylesheet href="{tmp_path / "pipe"}"?>'
    outside = f'<!DOCTYPE svg SYSTEM "{tmp_path / "pipe"}">'
    room = '<rect class="room" width="400" height="300"/>'
    names = 'xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink"'
    inner = REFERENCES.format(tmp_path / "pipe")
    (tmp_path / "plan.svg").write_text(f"{sheet}{outside}<svg {names}>{room}{inner}</svg>")
    plan = read_plan_file(tmp_path / "plan.svg", 0.01)
    assert [room.polygon_m.shape for room in plan.rooms] == [(4, 2)]
