"""What the documents say is true: verbs, options, extras, links and examples exist."""

from __future__ import annotations

import ast
import re
import shlex
import tomllib
from collections.abc import Iterator
from pathlib import Path

from chord_usd.cli import build_parser
from chord_usd.library.catalogue import designs
from tests.documents import CARDS, DOCUMENTS, ROOT, command_lines, fences, verb_of
from tests.every import for_every
from tests.unit.test_architecture import parsed
from tests.verbs import ACTIONS, VERBS

OPTIONS = {option for _, action in ACTIONS for option in action.option_strings}
OF_OTHERS = {"--head", "--dependency", "--force-reinstall"}
"""Options of ray, Slurm and pip that documents and error lines name."""

LONGEST = {ROOT / "README.md": 100, ROOT / "ARCHITECTURE.md": 130, **dict.fromkeys(CARDS, 60)}
"""Lines: what is longer is not read."""


def name_of(document: Path) -> str:
    return str(document.relative_to(ROOT))


def test_every_verb_has_one_line_and_one_example() -> None:
    lines = [
        line for block in fences((ROOT / "docs/commands.md").read_text())
        for line in block.splitlines() if line
    ]  # fmt: skip
    said, shown = lines[::2], lines[1::2]
    assert all(line.startswith("# ") for line in said)
    assert sorted(str(verb_of(line)) for line in shown) == sorted(VERBS)


def make_targets(text: str) -> set[str]:
    """The targets that a text asks make for."""
    return set(re.findall(r"(?:^|`)make ([a-z][\w-]*)", text, re.MULTILINE))


def test_the_readme_names_one_command_that_makes_a_house_and_one_that_tests() -> None:
    assert make_targets((ROOT / "README.md").read_text()) == {"house", "test"}
    assert "test" in make_targets((ROOT / ".ci/run").read_text())


def test_targets_of_make_that_are_named_exist() -> None:
    exist = set(re.findall(r"^([a-z][\w-]*):", (ROOT / "Makefile").read_text(), re.MULTILINE))
    named = {d: make_targets(d.read_text()) for d in [*DOCUMENTS, ROOT / ".ci/run"]}
    assert named[ROOT / "CONTRIBUTING.md"] >= {"setup-dev", "lint", "test", "acceptance"}
    assert {name_of(d): wrong for d, targets in named.items() if (wrong := targets - exist)} == {}


@for_every("document", DOCUMENTS, ids=name_of)
def test_commands_can_be_typed(document: Path) -> None:
    """Whole ones parse; of those that are only mentioned, verbs and options exist.

    A line in a sentence is whole if it says more than a verb; N, ID and the like stand for values.
    """
    text = document.read_text()
    for line in command_lines(text):
        build_parser().parse_args(shlex.split(line.split(" #")[0])[1:])
    for span in re.findall(r"`([^`\n]+)`", text):
        if span.startswith("chord-usd ") and " --" in span and verb_of(span):
            build_parser().parse_args(shlex.split(re.sub(r"\bN\b", "1", span))[1:])
        if span.startswith("chord-usd ") and span.split()[1][0].islower():
            assert verb_of(span) or any(v.startswith(f"{span.split()[1]} ") for v in VERBS), span
        if span.startswith(("-", "chord-usd", "train", "evaluate", "generate", "render")):
            named = set(re.findall(r"(?<![\w-])--[a-z][\w-]*", span))
            assert named <= OPTIONS | OF_OTHERS, span


def test_every_option_is_on_a_page() -> None:
    named = {
        option
        for document in DOCUMENTS
        for option in re.findall(r"(?<![\w-])--?[a-z][\w-]*", document.read_text())
    }
    unnamed = [
        f"{prog} {action.option_strings[-1]}"
        for prog, action in ACTIONS
        if action.option_strings and not named & set(action.option_strings)
    ]
    assert unnamed == []


def remedies() -> Iterator[tuple[str, str]]:
    """What error lines say after "Try:": the module, and the text with X for what is filled in."""
    for file in sorted((ROOT / "chord_usd").rglob("*.py")):
        for node in ast.walk(parsed(file)):
            if not isinstance(node, ast.keyword) or node.arg != "try_":
                continue
            for text in ast.walk(node.value):
                if isinstance(text, ast.JoinedStr):
                    parts = (p.value if isinstance(p, ast.Constant) else "X" for p in text.values)
                    yield name_of(file), "".join(map(str, parts))
                elif isinstance(text, ast.Constant) and isinstance(text.value, str):
                    yield name_of(file), text.value


def test_commands_of_error_lines_can_be_typed() -> None:
    """Verbs and options of every "Try:" exist; pip installs what an index or a clone has."""
    wrong, texts = [], list(remedies())
    for file, text in texts:
        for line in re.findall(r"chord-usd [a-z][^,;(]*", text):
            words = line.split()[1:]
            is_verb = verb_of(line) or any(verb.startswith(f"{words[0]} ") for verb in VERBS)
            is_prose = words[0] in ("on", "wrote", "version", "again")
            if not (is_verb or is_prose):
                wrong.append(f"{file}: {line}")
        named = set(re.findall(r"(?<![\w-])--[a-z][\w-]*", text))
        unknown = named - OPTIONS - OF_OTHERS
        wrong += [f"{file}: {option}" for option in unknown]
    assert len(texts) > 100
    assert wrong == []


def test_extras_are_installed_from_a_clone() -> None:
    """The package is on no index: pip finds no chord-usd there."""
    code = [file for part in ("chord_usd", "blender_addon") for file in (ROOT / part).rglob("*.py")]
    texts = {*DOCUMENTS, *code} - {ROOT / "CHANGELOG.md"}
    wrong = re.compile(r"pip install (--force-reinstall )?'?chord-usd")
    assert [name_of(text) for text in texts if wrong.search(text.read_text())] == []


def test_models_are_counted_once() -> None:
    """Pages give the number of models that the catalogue has."""
    given = {
        int(number.replace(",", ""))
        for document in DOCUMENTS
        if document.name != "CHANGELOG.md"
        for number in re.findall(r"([\d,]{3,}) (?:models|packages)\b", document.read_text())
    }
    assert given == {len(designs())}


@for_every("document", DOCUMENTS, ids=name_of)
def test_extras_and_links_lead_somewhere(document: Path) -> None:
    text = document.read_text()
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    named = re.findall(r"(?:chord-usd|'\.)\[([\w,-]+)\]", text)
    assert {e for one in named for e in one.split(",")} <= set(project["optional-dependencies"])
    for target in re.findall(r"\]\(([^)\s]+)\)", text):
        if target.startswith(("http:", "https:")):
            continue
        path, _, anchor = target.partition("#")
        file = (document.parent / path).resolve() if path else document
        assert file.exists(), target
        if anchor:
            titles = re.findall(r"^#+ (.+)$", file.read_text(), re.MULTILINE)
            assert anchor in {re.sub(r"[^\w -]", "", t.lower()).replace(" ", "-") for t in titles}


@for_every("document", DOCUMENTS, ids=name_of)
def test_modules_that_are_named_exist(document: Path) -> None:
    """Paths of this repository in backticks; a part of a path will do inside the package."""
    for span in re.findall(r"`([\w/.]+\.py|chord_usd/[\w/.]+)`", document.read_text()):
        if "NAME" in span:
            continue
        near = (ROOT / span, ROOT / "chord_usd" / span, document.parent / span)
        assert any(path.exists() for path in near) or any(ROOT.glob(f"*/**/{span}")), span


@for_every("document", LONGEST, ids=name_of)
def test_documents_are_short_enough_to_read(document: Path) -> None:
    lines = len(document.read_text().splitlines())
    assert lines <= LONGEST[document]
