"""Names and words that say nothing: none is added, and each that goes lowers the figure here."""

import ast
import re
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import chord_usd

EMPTY_NAMES = {"one", "own", "found", "told", "tell"}
MOST_NAMES = 28
"""Bindings that are left: methods, and fields that files hold."""

PRIVATE_WORDS = re.compile(r"\b(anew|shall|in the way|of ours|wears?|tells?|told)\b")
MOST_LINES = 119
"""Lines with such a word: user's sentences, settings of looks and fields among them."""

_FILES = sorted(Path(chord_usd.__file__).parent.rglob("*.py"))


def _bound(tree: ast.AST) -> Iterator[str]:
    for node in ast.walk(tree):
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            yield node.id
        elif isinstance(node, ast.arg):
            yield node.arg
        elif isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            yield node.name


def test_names_say_what_they_hold() -> None:
    bound = Counter(
        f"{file.name}: {name}"
        for file in _FILES
        for name in _bound(ast.parse(file.read_text()))
        if name.strip("_").lower() in EMPTY_NAMES
    )
    assert bound.total() <= MOST_NAMES, dict(bound)


def test_words_are_those_of_the_field() -> None:
    lines = [
        f"{file.name}:{number}: {line.strip()}"
        for file in _FILES
        for number, line in enumerate(file.read_text().splitlines(), 1)
        if PRIVATE_WORDS.search(line)
    ]
    assert len(lines) <= MOST_LINES, lines
