"""Rules of a stage: every broken fixture trips the rule it is named after, and no other."""

from __future__ import annotations

from pathlib import Path

import pytest
from pxr import Usd

from chord_usd.line.stage.check.check_rules import RULES, broken_rules

FIXTURES = Path(__file__).parents[1] / "fixtures"
BROKEN = sorted((FIXTURES / "broken").glob("CHORD*.usda"))

ALSO = {"CHORD005": {"CHORD008"}}
"""An absolute path to nowhere is also missing, and USD's own validators say so too."""


def rules_broken_by(path: Path) -> set[str]:
    return {finding.rule for finding in broken_rules(Usd.Stage.Open(str(path)))}


def test_every_rule_has_a_fixture():
    assert [path.name.split("_")[0] for path in BROKEN] == list(RULES)


def test_the_plain_stage_breaks_no_rule():
    assert rules_broken_by(FIXTURES / "plain_stage.usda") == set()


@pytest.mark.parametrize("path", BROKEN, ids=lambda path: path.stem)
def test_a_broken_stage_trips_its_own_rule_only(path):
    rule = path.name.split("_")[0]
    assert rules_broken_by(path) - ALSO.get(rule, set()) == {rule}


def test_findings_name_the_prim_and_say_what_is_wrong():
    path = FIXTURES / "broken" / "CHORD002_component_in_component.usda"
    (finding,) = broken_rules(Usd.Stage.Open(str(path)))
    assert finding.path == "/House/Rooms/Desk/Laptop"
    assert "/House/Rooms/Desk" in finding.message


def test_a_fault_inside_an_instance_is_told_once_through_an_instance(tmp_path):
    part = (FIXTURES / "broken" / "CHORD006_no_extent.usda").resolve()
    stage = Usd.Stage.CreateInMemory()
    for name in ("A", "B"):
        prim = stage.DefinePrim(f"/World/{name}", "Xform")
        prim.GetReferences().AddReference(str(part), "/House/Rooms/Room")
        prim.SetInstanceable(True)
    assert len(stage.GetPrototypes()) == 1
    paths = [f.path for f in broken_rules(stage) if f.rule == "CHORD006"]
    assert paths == ["/World/A/Floor", "/World/A/Wall"]


def test_usds_own_validators_are_asked(tmp_path):
    bare = tmp_path / "bare.usda"
    bare.write_text('#usda 1.0\n\ndef Xform "World"\n{\n}\n')
    assert {"MissingUpAxisMetadata", "MissingMetersPerUnitMetadata"} <= rules_broken_by(bare)
