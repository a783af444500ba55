"""What an SVG's style sheets and attributes say of how its shapes are drawn."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from xml.etree.ElementTree import Element

from chord_usd.line.plan.vector.safe_xml import local_name
from chord_usd.line.plan.vector.svg_shapes import numbers

_RULE = re.compile(r"([^{}]+)\{([^{}]*)\}")
_COMMENT = re.compile(r"/\*.*?\*/", re.S)
_SELECTOR = re.compile(r"([\w-]+|\*)?((?:[.#][\w-]+)*)")
_DECLARATION = re.compile(r"([\w-]+)\s*:\s*([^;!]+)")
_PROPERTIES = ("display", "visibility", "fill", "fill-rule", "stroke-width")
_INVISIBLE = ("none", "transparent")


@dataclass(frozen=True)
class _Rule:
    tag: str
    parts: frozenset[str]
    """Classes and ids, as ".wall" and "#walls"."""
    declared: Mapping[str, str]

    @property
    def weight(self) -> tuple[int, int, int]:
        """What overrules what: ids, classes, tags."""
        ids = sum(part.startswith("#") for part in self.parts)
        return ids, len(self.parts) - ids, int(bool(self.tag))


@dataclass(frozen=True)
class Style:
    """How an element is drawn; most of it is inherited from group to group."""

    stroke: float = 0.0
    """Width of lines, units of the element."""
    is_filled: bool = True
    is_even_odd: bool = False
    """By which rule outlines in one another are holes; else by their directions."""
    is_visible: bool = True
    is_displayed: bool = True
    """Not inherited: what is not displayed hides all in it."""


class StyleSheet:
    """The rules of an SVG's style elements: those for one tag, its classes and its id."""

    def __init__(self, root: Element) -> None:
        texts = ("".join(e.itertext()) for e in root.iter() if local_name(e) == "style")
        rules = (rule for text in texts for rule in _rules(_COMMENT.sub(" ", text)))
        self._rules = sorted(rules, key=lambda rule: rule.weight)

    def style(self, element: Element, outer: Style) -> Style:
        """The style of an element in one of the style `outer`."""
        said = self._declared(element)
        width = numbers(said.get("stroke-width", ""))
        fill, visibility = said.get("fill"), said.get("visibility")
        rule = said.get("fill-rule")
        return Style(
            width[0] if width else outer.stroke,
            fill not in _INVISIBLE if fill else outer.is_filled,
            rule == "evenodd" if rule else outer.is_even_odd,
            visibility == "visible" if visibility else outer.is_visible,
            said.get("display") != "none",
        )

    def _declared(self, element: Element) -> Mapping[str, str]:
        said = {name: element.get(name, "") for name in _PROPERTIES if element.get(name)}
        own = {f".{name}" for name in element.get("class", "").split()}
        own |= {f"#{element.get('id')}"}
        for rule in self._rules:
            if rule.tag in ("", local_name(element)) and rule.parts <= own:
                said |= rule.declared
        said |= _declarations(element.get("style", ""))
        return {name: value.strip().lower() for name, value in said.items()}


def _rules(text: str) -> Iterator[_Rule]:
    for selectors, body in _RULE.findall(text):
        for selector in selectors.split(","):
            match = _SELECTOR.fullmatch(selector.strip())
            if match and selector.strip():
                parts = frozenset(re.findall(r"[.#][\w-]+", match[2]))
                yield _Rule((match[1] or "").replace("*", ""), parts, _declarations(body))


def _declarations(text: str) -> dict[str, str]:
    return dict(_DECLARATION.findall(text))
