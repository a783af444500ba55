"""Schemas of what --json prints: valid, and as strict as the types are."""

from __future__ import annotations

import json

import jsonschema
import pytest

from chord_usd.cli import main
from chord_usd.faces.commands.results import RESULTS, schema_of
from tests.every import for_every


@for_every("verb", RESULTS)
def test_every_result_has_a_closed_schema(verb: str) -> None:
    schema = schema_of(verb)
    jsonschema.Draft202012Validator.check_schema(schema)
    assert schema["required"]
    assert not schema["additionalProperties"]


def test_a_key_that_is_missing_new_or_of_another_type_breaks_the_schema() -> None:
    right = {"plan": "plan.png", "m_per_px": 0.05}
    jsonschema.validate(right, schema_of("plan draw"))
    for wrong in ({"plan": "plan.png"}, {**right, "more": 1}, {**right, "m_per_px": "5 cm"}):
        with pytest.raises(jsonschema.ValidationError):
            jsonschema.validate(wrong, schema_of("plan draw"))


def test_a_verb_prints_its_schema(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as left:
        main(["plan", "read", "--json-schema"])
    assert left.value.code == 0
    assert json.loads(capsys.readouterr().out) == schema_of("plan read")
