"""YAML from anywhere -> Python values, without what makes YAML dangerous.

Nothing is constructed but plain values; aliases, by which a small text grows without end, and deep
nesting are refused before anything is built.
"""

from __future__ import annotations

from typing import Any

from chord_usd.base.errors import ChordError
from chord_usd.base.runtime.json_text import MOST_NESTED

MOST_BYTES = 4 * 2**20
"""A layout of RoboCasa has 15,000."""


def parse_yaml(data: bytes, where: str, error: type[ChordError] = ChordError) -> Any:
    """The values of a YAML document in UTF-8.

    where: what messages call it. Raises error for what is no YAML, aliases, tags other than of
    plain values, and what is longer than MOST_BYTES or nested more than MOST_NESTED deep.
    """
    import yaml

    if len(data) > MOST_BYTES:
        raise error("is too long for YAML", where=where, expected=f"at most {MOST_BYTES:,} bytes")
    loader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
    try:
        depth = 0
        for event in yaml.parse(data, Loader=loader):
            depth += isinstance(event, yaml.CollectionStartEvent)
            depth -= isinstance(event, yaml.CollectionEndEvent)
            if isinstance(event, yaml.AliasEvent) or depth > MOST_NESTED:
                raise error(
                    "has aliases or is nested too deeply", where=where,
                    expected=f"YAML without aliases, at most {MOST_NESTED} levels",
                )  # fmt: skip
        return yaml.load(data, Loader=loader)
    except (yaml.YAMLError, UnicodeDecodeError, ValueError) as problem:
        what = " ".join(str(problem).split())
        raise error(f"is not YAML ({what:.160})", where=where, expected="a document") from problem
