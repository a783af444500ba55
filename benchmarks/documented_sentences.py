"""Sentences of README and the documents, said to ten houses: a document that is refused is wrong.

    python benchmarks/documented_sentences.py [--houses N] [--say SENTENCE ...] [--steps N]

Half of the houses are the examples, half procedural plans. Each sentence is said to each house by
the function of `chord-usd edit`, as a dry run, which refuses what an edit refuses. What README
tells users to type has to be done in all of them: exit code 1 otherwise. Other documents name
rooms and pieces that not every home has; the table says in how many they are done.
"""

from __future__ import annotations

import argparse
import re
import sys
import tempfile
from collections import defaultdict
from pathlib import Path

import numpy as np

from chord_usd.base.errors import ChordError
from chord_usd.base.scene.chord_json import write_plan
from chord_usd.line.pipeline import Settings, generate, load_models
from chord_usd.line.pipeline.edit_house import edit
from chord_usd.workshop.data.floorplans.programme import spread_room_count
from chord_usd.workshop.data.houses import random_plan

ROOT = Path(__file__).resolve().parents[1]
EXAMPLES = ("two_bedrooms.png", "studio.png", "family_house.png", "balcony_flat.json",
            "cut_corner.png")  # fmt: skip
_SAID = re.compile(r'(?:chord-usd edit \S+|\.edit\()\s*"([^"\n]+)"')
_APART = 70_000
"""Seeds of plans begin here: those of tests are smaller."""


def documented(file: Path) -> list[str]:
    """The sentences that a document tells users to say."""
    return list(dict.fromkeys(_SAID.findall(file.read_text())))


def plans(count: int, folder: Path) -> list[Path]:
    """Examples first, then procedural plans."""
    found = [ROOT / "examples" / name for name in EXAMPLES][:count]
    for number in range(1, 1 + count - len(found)):  # the first is a single room, no home
        found.append(folder / f"plan_{number}.json")
        rng = np.random.default_rng(_APART + number)
        write_plan(random_plan(rng, spread_room_count(number)), found[-1])
    return found


def main() -> int:
    """Returns the exit code."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--houses", type=int, default=10)
    parser.add_argument("--steps", type=int, help="sampler steps (the checkpoint's own)")
    parser.add_argument("--say", action="append", default=[], help="also this sentence")
    options = parser.parse_args()
    required = documented(ROOT / "README.md")
    others = [one for file in sorted((ROOT / "docs").glob("*.md")) for one in documented(file)]
    sentences = list(dict.fromkeys([*required, *others, *options.say]))
    refused: defaultdict[str, list[str]] = defaultdict(list)
    settings = Settings(steps=options.steps, tabletop=False)
    models = load_models(settings)
    with tempfile.TemporaryDirectory() as folder:
        for plan in plans(options.houses, Path(folder)):
            house = Path(folder, plan.stem, "house.usda")
            house.parent.mkdir()
            generate(plan, house, settings, models=models)
            for sentence in sentences:
                try:
                    edit(house, sentence, house, dry_run=True)
                except ChordError as error:
                    refused[sentence].append(plan.stem)
                    sys.stderr.write(f"{plan.stem}: {sentence}: {error.what}\n")
    for sentence in sentences:
        done = options.houses - len(refused[sentence])
        where = "README" if sentence in required else "documents"
        sys.stdout.write(f"{done} of {options.houses}  {where}: {sentence}\n")
    return int(any(refused[sentence] for sentence in required))


if __name__ == "__main__":
    sys.exit(main())
