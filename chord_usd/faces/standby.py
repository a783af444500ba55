"""A process that waits for command lines with all that furnishes houses loaded.

A page runs its verbs here: to start, to import torch and to load networks takes longer than a room.
Lines of JSON come in, {"words": [...]}; each is run as the command line would. Its answer goes to
standard output; progress and errors go to standard error, and {"over": CODE} at the end.
"""

from __future__ import annotations

import json
import os
import select
import sys
from collections.abc import Callable, Iterator

from chord_usd import cli
from chord_usd.base.runtime import console, interrupts
from chord_usd.base.runtime.locations import keep_caches
from chord_usd.base.runtime.offline import stay_offline


def main() -> int:
    """Serve until standard input ends; returns the exit code."""
    stay_offline()
    keep_caches()
    interrupts.obey()
    interrupts.watch()
    try:
        for words in _lines():
            interrupts.delivered.clear()
            code = cli.main(words)
            if reason := interrupts.came():
                return reason.code
            sys.stderr.write(json.dumps({"over": code}) + "\n")
            sys.stderr.flush()
    except interrupts.Interrupted as reason:
        return reason.code
    return 0


def _lines() -> Iterator[list[str]]:
    """The command lines as they come. While none waits, something is loaded for those to come."""
    left = list(PARTS)
    text = b""
    while True:
        while b"\n" not in text:
            if left and not select.select([0], [], [], 0)[0]:
                load(left.pop(0))
                continue
            more = os.read(0, 65536)
            if not more:
                return
            text += more
        line, _, text = text.partition(b"\n")
        yield json.loads(line)["words"]


def load(part: Callable[[], None]) -> None:
    """The verb that needs a module reports that it cannot be loaded."""
    try:
        with console.reserved():
            part()
    except interrupts.Interrupted:
        raise
    except Exception:
        return


def _import_reading() -> None:
    import chord_usd.line.plan.read  # noqa: F401


def _import_furnishing() -> None:
    import chord_usd.line.layout.sample
    import chord_usd.line.layout.upright
    import chord_usd.line.lists.list_sampler  # noqa: F401


def _load_models() -> None:
    from chord_usd.line.pipeline import Settings
    from chord_usd.line.pipeline.loading import keep_models

    keep_models(Settings())


def _import_authoring() -> None:
    import chord_usd.line.dressing.dress
    import chord_usd.line.stage.author.author_stage
    import chord_usd.line.stage.check.check_stage
    import chord_usd.line.stage.export.gltf  # noqa: F401


PARTS = (_import_reading, _import_furnishing, _load_models, _import_authoring)
"""What verbs that furnish need, in the order in which they need it."""


if __name__ == "__main__":
    sys.exit(main())
