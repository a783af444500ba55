"""Nouns after numbers, and the addresses that a server prints."""

from __future__ import annotations

import ipaddress
import re
from pathlib import Path

import pytest

from chord_usd.base.runtime.counting import counted
from chord_usd.faces.page import serving

COMMANDS = Path(__file__).parents[2] / "chord_usd/faces/commands"
COUNTED = re.compile(
    r"\{(?!LEAST|MOST|SEEDS)[^{}]*\} (?:new )?(?:pieces|steps|rooms|houses|models|packages|looks|"
    r"components|tasks|items|storeys|doors|windows|passages|openings|pictures|cases)\b(?! are)"
)
"""A noun in the plural, whatever the number before it is."""


def test_nouns_agree_with_their_numbers() -> None:
    assert [counted(n, "piece") for n in (0, 1, 2)] == ["0 pieces", "1 piece", "2 pieces"]
    assert counted(2, "box", "boxes") == "2 boxes"


def test_verbs_count_through_one_function() -> None:
    wrong = [
        f"{file.name}: {found}"
        for file in COMMANDS.glob("*.py")
        for found in COUNTED.findall(file.read_text())
    ]
    assert wrong == []


@pytest.mark.parametrize(
    ("host", "shown"), [("127.0.0.1", "127.0.0.1"), ("::1", "[::1]"), ("192.0.2.7", "192.0.2.7")]
)
def test_an_interface_is_its_address(host: str, shown: str) -> None:
    assert serving.shown_address(host) == shown


@pytest.mark.parametrize("host", ["0.0.0.0", "::"])
def test_all_interfaces_have_an_address_that_others_can_use(
    host: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert not ipaddress.ip_address(serving.shown_address(host).strip("[]")).is_unspecified
    monkeypatch.setattr(serving, "_addresses", lambda: ["127.0.0.1", "192.0.2.7"])
    assert serving.shown_address(host) == "192.0.2.7"
    monkeypatch.setattr(serving, "_addresses", lambda: ["127.0.0.1"])
    assert serving.shown_address(host) == "127.0.0.1"
