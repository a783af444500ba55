"""Random verbs with random outputs over a tree of somebody's files: what was not asked for stays.

    python benchmarks/strangers_tree.py [--runs N] [--seed N] [--write]

The tree holds documents, a house, houses and a training run of our own, links, hard links, a
pipe, read-only and hidden files, and odd names. Each run takes a verb, read off the parser, and
leads one or more of its outputs to a random place, there or not. A run that is refused must change
nothing. One that is done may change the file that it was told to write, add files beside it or in
the folder that it was told to fill, and replace there what chord-usd wrote itself. The tree is made
again after every run that wrote. Exit code 1 says that something else was touched, or badly told.
"""

from __future__ import annotations

import argparse
import os
import shutil
import sys
import tempfile
import time
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from random import Random

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT))

from outside import watch  # noqa: E402
from results import write_section  # noqa: E402

from chord_usd.base.runtime.scratch import PREFIX  # noqa: E402
from chord_usd.base.runtime.targets import (  # noqa: E402
    MANIFEST_FILE,
    Manifest,
    begin_run,
)
from chord_usd.base.scene.chord_json import read_scene  # noqa: E402
from chord_usd.cli import build_parser, main  # noqa: E402
from tests.strangers_verbs import ENDLESS, INPUTS, OUTPUTS, make_home, option_strings  # noqa: E402

OWN = "own"
"""Folder in the tree with what chord-usd wrote."""

QUICK: dict[str, tuple[str, ...]] = {
    "generate": ("--steps", "1", "--redraws", "0", "--no-tabletop"),
    "layout": ("--steps", "1"),
    "regenerate": ("--steps", "1", "--no-tabletop"),
    "batch": ("--steps", "1", "--redraws", "0", "--no-tabletop", "--workers", "1"),
    "render": ("--samples", "1", "--resolution", "32x32", "--camera", "Top"),
    "dataset synth": ("--rooms", "3"),
    "dataset draw": ("--most", "1"),
    **{verb: ("--minutes", "0.001") for verb in INPUTS if verb.startswith("train ")},
    "train next": ("--minutes", "0.001", "--network", "lists"),
    "evaluate layouts": ("--n", "1", "--steps", "1", "--no-fid"),
    "evaluate ood": ("--n", "1", "--draws", "1", "--per-room", "1"),
    "evaluate speed": ("--n", "1", "--steps", "1", "--no-fid"),
    "evaluate diversity": ("--n", "1", "--steps", "1", "--seeds", "2"),
    "evaluate plans": ("--count", "1"),
    "evaluate detector": ("--houses", "1"),
}  # fmt: skip
"""Settings with which a verb is soon done."""

WHOLE = frozenset({"train next"})
"""Verbs that replace their process."""

_WEIGHTS = (("train", 1), ("evaluate", 1), ("batch", 1), ("render", 1), ("assets build", 1),
            ("generate", 3), ("regenerate", 3))  # fmt: skip
"""Verbs that may take long come up less often; others have 12."""

_GOES_ON = ("output_run", "output_place")
"""Outputs in which a run that was stopped leaves what the next one goes on from."""

_SHARE_WHOLE = 20
_SUFFIXES = ("", ".usda", ".usdz", ".json", ".png", ".md", ".glb")


@dataclass(frozen=True)
class Target:
    """An output that a run was given."""

    path: Path
    """Absolute, its links not followed."""
    kind: str
    """Which of commands.paths."""

    @property
    def is_file(self) -> bool:
        """Or else a folder."""
        return self.kind == "output_file"


def make_tree(tree: Path) -> None:
    """Fill the tree."""
    tree.mkdir()
    house = read_scene(ROOT / "tests" / "fixtures" / "furnished_house.json")
    make_home(tree, house)
    for name in (
        "letters/2024",
        "letters/empty",
        "Größe und Maß",
        "new\nline",
        ".private",
        "locked",
    ):
        (tree / name).mkdir(parents=True)
        if "empty" not in name:
            (tree / name / "note.txt").write_text(f"about {name}")
    (tree / "letters" / "house.usda").write_text("not a stage of anybody")
    (tree / "letters" / "materials").write_text("a list, not a folder")
    (tree / "Größe und Maß" / "plän\n.png").write_bytes(b"a picture")
    (tree / ".private" / ".key").write_text("secret")
    _make_own(tree)
    (tree / "link to letters").symlink_to("letters")
    (tree / "link.usda").symlink_to("letters/house.usda")
    (tree / "dangling.json").symlink_to("nowhere.json")
    (tree / "loop").symlink_to("loop")
    os.link(tree / "mine" / "thesis.txt", tree / "thesis.png")
    os.mkfifo(tree / "pipe.json")
    (tree / "locked" / "note.txt").chmod(0o400)
    (tree / "locked").chmod(0o500)


def _make_own(tree: Path) -> None:
    own = tree / OWN
    for words in (
        ("stage", tree / "scene.json", "-o", own / "house" / "house.usda"),
        ("dataset", "synth", "--count", "1", "--rooms", "3", "-o", own / "houses"),
    ):
        assert main([*map(str, words), "--progress", "none"]) == 0
    begin_run(own / "run")
    (own / "house" / "added by hand.txt").write_text("a remark")
    (own / "houses" / "notes.txt").write_text("a remark")


def command(rng: Random, tree: Path) -> tuple[str, list[str], list[Target]]:
    """A verb, its words, and what it was told to write."""
    verbs = sorted(INPUTS.keys() - ENDLESS)
    verb = rng.choices(verbs, [_weight(one) for one in verbs])[0]
    real = {"house.usda": f"{OWN}/house/house.usda"} if rng.random() < 0.7 else {}
    given = [real.get(word, word) for word in INPUTS[verb]]
    words = [*verb.split(), *given, *QUICK.get(verb, ())]
    places = [(option, kind) for name, option, kind in OUTPUTS if name == verb]
    targets: list[Target] = []
    for option, kind in places:
        if option == "--output" or rng.random() < 0.3:
            named = _place(rng, tree, verb)
            words.append(f"{'-o' if option == '--output' else option}")
            words.append(named if not named.startswith("-") else f"./{named}")
            path = Path(os.path.abspath(tree / named))  # noqa: PTH100 (its links are not followed)
            targets.append(Target(path, kind))
    if "--overwrite" in option_strings(build_parser(), verb) and rng.random() < 0.5:
        words.append("--overwrite")
    return verb, words, targets


def _weight(verb: str) -> int:
    return next((weight for name, weight in _WEIGHTS if verb.startswith(name)), 12)


def _place(rng: Random, tree: Path, verb: str) -> str:
    """A path: of what is there, or new; as it is written by one who has no care."""
    there = sorted(tree.rglob("*"))
    shallow = [one for one in there if len(one.relative_to(tree).parts) <= 2]
    one = rng.choice(shallow if rng.random() < 0.8 else there)
    folder = one if one.is_dir() else one.parent
    path = rng.choice((one, one, folder, folder / "fresh", tree / "fresh" / "deep" / "er", tree))
    text = os.path.relpath(path, tree) if rng.random() < 0.8 else str(path)
    if path != one and rng.random() < 0.8:
        text += rng.choice(_SUFFIXES)
    elif rng.random() < 0.2:
        text = rng.choice((f"{text}/", f"mine/../{text}", "..", "../beside", f"{text}/house.usda"))
    return text


def touched(run: watch.Run, before: watch.Look, after: watch.Look, base: Path, owned: set[str],
            targets: list[Target]) -> list[str]:  # fmt: skip
    """What the run changed and nobody asked for."""
    return [
        change
        for name in sorted(before.keys() | after.keys())
        if before.get(name) != after.get(name)
        and not _asked(name, name in before, run, base, owned, targets)
        for change in watch.changes({name: before[name]} if name in before else {},
                                    {name: after[name]} if name in after else {})
    ]  # fmt: skip


def _asked(
    name: str, was_there: bool, run: watch.Run, base: Path, owned: set[str], targets: list[Target]
) -> bool:
    path = base / name
    stopped = run.code is None
    if run.code not in (0, 1) and not stopped:
        return False
    if stopped and PREFIX in name:
        return True
    if stopped and not was_there and any(one.path.is_relative_to(path) for one in targets):
        return True  # folders on the way to a target; nobody was left to take them away
    for target in targets:
        if stopped and target.kind not in _GOES_ON:
            continue
        real = Path(os.path.realpath(target.path))
        home = real.parent if target.is_file else real
        if was_there and path in (target.path, real) and target.is_file:
            return True
        if (
            was_there
            and path.is_relative_to(home)
            and (name in owned or path.name == MANIFEST_FILE)
        ):
            return True
        if not was_there and (path.is_relative_to(home) or home.is_relative_to(path)):
            return True
    return False


def owned_in(base: Path) -> set[str]:
    """Files that the manifests in a tree list."""
    found = set()
    for manifest in base.rglob(MANIFEST_FILE):
        files = Manifest(manifest.parent)
        there = (one for one in manifest.parent.rglob("*") if one.is_file())
        found |= {os.path.relpath(one, base) for one in there if files.lists(one)}
    return found


class Bench:
    """A template of the tree, and a copy that the runs work on."""

    def __init__(self, folder: Path) -> None:
        self.folder, self.base = folder, folder / "work"
        for name in ("home", "tmp", "cache"):
            (folder / name).mkdir()
        os.environ["CHORD_USD_CACHE"] = str(folder / "cache")
        make_tree(folder / "template")
        self.base.mkdir()
        self.copy()
        env = os.environ | {
            "HOME": str(folder / "home"), "TMPDIR": str(folder / "tmp"), "PYTHONPATH": str(ROOT),
        }  # fmt: skip
        self.env = env
        self.server = watch.Server(self.base / "tree", env, most_runs=150)

    def copy(self) -> None:
        """Make the tree again. What a run has put beside it goes, too: all of it is ours."""
        for entry in self.base.iterdir():
            shutil.rmtree(entry) if entry.is_dir() and not entry.is_symlink() else entry.unlink()
        tree = self.base / "tree"
        shutil.copytree(self.folder / "template", tree, symlinks=True, copy_function=_copied,
                        ignore=lambda _, names: [n for n in names if n == "pipe.json"])  # fmt: skip
        os.mkfifo(tree / "pipe.json")
        (tree / "thesis.png").unlink()
        os.link(tree / "mine" / "thesis.txt", tree / "thesis.png")
        self.owned = owned_in(self.base)
        self.before = watch.look(self.base)

    def run(self, words: list[str], *, whole: bool) -> watch.Run:
        said = [*words, "--progress", "none"]
        if whole:
            return watch.whole(said, self.base / "tree", self.env)
        return self.server.run(said)


def _copied(source: str, target: str) -> str:
    return shutil.copy2(source, target, follow_symlinks=False)


def work(bench: Bench, runs: int, seed: int, write: bool) -> int:
    """So many runs; 1 if one of them did what it may not."""
    verbs, codes, violations = Counter[str](), Counter[object](), 0
    written = 0
    start = time.monotonic()
    for number in range(runs):
        rng = Random(f"{seed}/{number}")
        verb, words, targets = command(rng, bench.base / "tree")
        whole = verb in WHOLE or number % _SHARE_WHOLE == _SHARE_WHOLE - 1
        run = bench.run(words, whole=whole)
        after = watch.look(bench.base)
        wrong = touched(run, bench.before, after, bench.base, bench.owned, targets)
        faults = [one for one in run.faults() if not one.startswith("took")]
        if bench.before != after:
            written += 1
            bench.server.close()  # its folder goes
            bench.copy()
        verbs[verb] += 1
        codes[run.code] += 1
        if wrong or faults:
            violations += 1
            said = f"{number}: {words!r}\n  {wrong[:5]} {faults}\n  {run.told.strip()[-300:]}\n"
            sys.stdout.write(said)
            sys.stdout.flush()
    rows = [
        ("runs", f"{runs} in {(time.monotonic() - start) / 60:.0f} min, seed {seed}"),
        ("violations", str(violations)),
        ("wrote something", str(written)),
        ("exit codes", ", ".join(f"{code}: {codes[code]}" for code in sorted(codes, key=str))),
        ("by verb", ", ".join(f"{verb} {count}" for verb, count in sorted(verbs.items()))),
    ]
    if write:
        write_section("A stranger's tree", rows, "`python benchmarks/strangers_tree.py`")
    sys.stdout.write("".join(f"{name}: {value}\n" for name, value in rows))
    return 1 if violations else 0


def run_all() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--runs", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--write", action="store_true", help="write the figures to RESULTS.md")
    options = parser.parse_args()
    # The folder stays, for whoever wants to look; it is of temporary files.
    bench = Bench(Path(tempfile.mkdtemp(prefix="chord-usd-tree-")).resolve())
    try:
        return work(bench, options.runs, options.seed, options.write)
    finally:
        bench.server.close()


if __name__ == "__main__":
    sys.exit(run_all())
