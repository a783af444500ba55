"""The tools of an agent, over the Model Context Protocol: verbs with typed arguments, and pictures.

Each tool writes one command line. What it does, what it refuses and what it answers is the verb's.
"""

from __future__ import annotations

import base64
import inspect
import io
import json
import tempfile
from collections import defaultdict
from collections.abc import AsyncIterator, Awaitable, Callable, Collection, Iterator, Sequence
from contextlib import AsyncExitStack, asynccontextmanager, contextmanager, redirect_stdout
from pathlib import Path
from typing import Annotated, Any

import anyio
from mcp.server.mcpserver import Context, MCPServer
from mcp.server.mcpserver.exceptions import ToolError
from mcp.types import ImageContent, TextContent, ToolAnnotations
from pydantic import Field

from chord_usd import __version__
from chord_usd.base.errors import ChordError
from chord_usd.base.runtime import console
from chord_usd.base.runtime.verb_calls import Answer, ReportProgress, run_verb
from chord_usd.base.scene.settings import OPTIONS, Option, offered_by, words_of
from chord_usd.base.scene.skies import TIMES
from chord_usd.faces.commands.agent_files import AgentFiles
from chord_usd.faces.commands.export import PACKAGES
from chord_usd.faces.commands.render import QUALITIES

MOST_PICTURES = 4
"""In one answer; the others are named, and lie below the root."""

PICTURE_PX = 1024
"""Longer side of a picture in an answer: models see no more, and clients limit answers."""

INSTRUCTIONS = """\
Furnish floor plans and edit furnished houses (OpenUSD). All paths are below one folder and relative
to it. list_files says what is there. A plan becomes a house with furnish; look shows a house and
names its rooms and pieces, which other tools take; edit changes a house as a sentence says,
refurnish_room furnishes one room again; undo takes back the latest change, redo repeats it, and
history lists all that was done; check says whether the certificate holds. Files are never replaced:
give new names."""

RunVerb = Callable[[Sequence[str], Path, ReportProgress], Awaitable[Answer]]
Content = list[TextContent | ImageContent]

House = Annotated[str, Field(description="a house, such as flat/house.usda")]
NewFile = Annotated[str, Field(description="a file to write; a name that is not taken")]
Package = Annotated[str, Field(json_schema_extra={"enum": list(PACKAGES)})]
Quality = Annotated[str, Field(json_schema_extra={"enum": list(QUALITIES)})]
Lighting = Annotated[str, Field(json_schema_extra={"enum": ["", *TIMES]})]


def _with_rows(
    *names: str, unset: Collection[str] = ()
) -> Callable[[Callable[..., Awaitable[Content]]], Callable[..., Awaitable[Content]]]:
    """Give a tool rows of the option table as parameters, in place of its **options.

    unset: rows without a default: the house decides.
    """

    def decorate(tool: Callable[..., Awaitable[Content]]) -> Callable[..., Awaitable[Content]]:
        known = inspect.signature(tool, eval_str=True)
        named = [p for p in known.parameters.values() if p.kind is not p.VAR_KEYWORD]
        rows = [_parameter(OPTIONS[name], name in unset) for name in names]
        tool.__signature__ = known.replace(parameters=[*named, *rows])  # type: ignore[attr-defined]
        tool.__annotations__ |= {row.name: row.annotation for row in rows}
        return tool

    return decorate


def _parameter(option: Option, is_unset: bool) -> inspect.Parameter:
    """A row as a parameter with a schema."""
    facts: dict[str, Any] = {"description": option.help}
    if option.limits:
        facts |= {"ge": option.limits[0], "le": option.limits[1]}
    if enum := option.choices or option.offered:
        facts["json_schema_extra"] = {"enum": list(dict.fromkeys(["", *enum]))}
    kind: Any = type(option.default)
    is_number = bool(option.limits)
    default = option.default
    if is_unset or default is None:
        default = None if is_number else ""
        kind = int | None if is_number else str
    return inspect.Parameter(
        option.name, inspect.Parameter.KEYWORD_ONLY, default=default,
        annotation=Annotated[kind, Field(**facts)],
    )  # fmt: skip


class HouseTools:
    """The tools, as methods; what their docstrings say is what an agent reads."""

    def __init__(self, files: AgentFiles, run: RunVerb = run_verb) -> None:
        self._files, self._run = files, run
        self._locks: defaultdict[Path, anyio.Lock] = defaultdict(anyio.Lock)

    async def list_files(self, folder: str = ".") -> Content:
        """List houses and other files in a folder and below."""
        with _told_as_tools_do():
            return _answered(self._files.listed(folder))

    async def read_plan(
        self,
        drawing: Annotated[str, Field(description="picture, PDF, SVG, DXF, IFC, Sweet Home 3D")],
        plan: NewFile,
        ctx: Context,
        rooms: Annotated[str, Field(description='corrections: "3: bedroom, 5: bathroom"')] = "",
        m_per_px: float | None = None,
    ) -> Content:
        """Read a drawing of a floor as a vector plan (.json); shows what was read over it."""
        with _told_as_tools_do(), _picture() as overlay:
            source, target = self._files.there(drawing), self._files.new(plan)
            words = ["plan", "read", self._word(source), *_option("output", self._word(target))]
            words += _option("rooms", rooms) + _option("scale", m_per_px)
            if source.suffix.lower() != ".json":  # which is no drawing
                words += _option("overlay", overlay)
            answer = await self._call(words, [source, target], ctx)
            return _answered(answer.data, [overlay])

    @_with_rows(*(option.name for option in offered_by("agent")))
    async def furnish(
        self,
        house: Annotated[str, Field(description="the new house, such as flat/house.usda")],
        ctx: Context,
        plan: Annotated[str, Field(description="a drawing, or a plan of read_plan")] = "",
        text: Annotated[str, Field(description="instead of a plan: what to build, in words")] = "",
        **options: Any,
    ) -> Content:
        """Furnish a floor plan as a new house, in about a minute; shows it from above."""
        with _told_as_tools_do(), _picture() as preview:
            target = self._files.new(house)
            source = [self._files.there(plan)] if plan else []
            words = ["generate", *map(self._word, source), *_option("output", self._word(target))]
            options["sky"] = self._sky(options.get("sky") or "")
            words += _option("text", text) + words_of(options) + _option("preview", preview)
            answer = await self._call(words, [*source, target], ctx)
            return _answered(answer.data, [preview])

    async def look(self, house: House, ctx: Context) -> Content:
        """Say what a house holds, and what looks can be chosen; shows it from above."""
        with _told_as_tools_do(), _picture() as preview:
            path = self._files.there(house)
            words = ["describe", self._word(path), *_option("preview", preview)]
            answer = await self._call(words, [path], ctx)
            return _answered(answer.data, [preview])

    @_with_rows("style", "seed", "steps", unset=("style", "seed"))
    async def refurnish_room(
        self,
        house: House,
        room: Annotated[str, Field(description="as look names it, such as Bedroom_0")],
        ctx: Context,
        wanted: Annotated[str, Field(description='pieces it must hold: "desk, two chairs"')] = "",
        unwanted: Annotated[str, Field(description="pieces it must not hold: sofa, bed")] = "",
        keep: Annotated[list[str], Field(description="pieces that stay, such as Bed_0")] = [],  # noqa: B006
        output: Annotated[str, Field(description="a new house; else this one is changed")] = "",
        **options: Any,
    ) -> Content:
        """Furnish one room again and leave the rest of the house as it is; undo takes it back."""
        with _told_as_tools_do():
            path = self._files.there(house)
            target = self._files.new(output) if output else path
            words = ["regenerate", self._word(path), *_option("output", self._word(target))]
            words += _option("room", room) + _option("with", wanted)
            words += _option("without", unwanted)
            words += [word for name in keep for word in _option("keep", name)]
            words += words_of(options, unset=("style", "seed"))
            answer = await self._call(words, [path, target], ctx)
            return _answered(answer.data)

    async def edit(
        self,
        house: House,
        ctx: Context,
        sentence: Annotated[str, Field(description='"put a plant in bedroom 1, no rug here"')] = "",
        state: Annotated[
            str, Field(description='instead: "doors: closed; bedroom 1 lamp: off"')
        ] = "",
        dry_run: Annotated[bool, Field(description="only say whether it can be done")] = False,
        force: Annotated[bool, Field(description="also where the house gets worse")] = False,
        output: Annotated[str, Field(description="a new house; else this one is changed")] = "",
    ) -> Content:
        """Change a house as a sentence in English says: add, remove, move, turn, swap, replace or
        lock pieces, restyle rooms. What is not understood, has no place, costs a room what it
        needs, or is no order but a statement or a question, changes nothing."""
        with _told_as_tools_do():
            path = self._files.there(house)
            target = self._files.new(output) if output else path
            words = ["edit", *_option("output", self._word(target))]
            # A blank before it: "-x" is no option, but a sentence that is not understood.
            words += ["--dry-run"] * dry_run + ["--force"] * force
            words += _option("state", state)
            words += [self._word(path), *([f" {sentence}"] if sentence else [])]
            answer = await self._call(words, [path, target], ctx)
            return _answered(answer.data)

    async def render(
        self,
        house: House,
        folder: Annotated[str, Field(description="a folder for the pictures")],
        ctx: Context,
        rooms: Annotated[list[str], Field(description="only in these, such as Bedroom_0")] = [],  # noqa: B006
        cameras: Annotated[list[str], Field(description="such as Top or Isometric")] = [],  # noqa: B006
        quality: Quality = "draft",
        lighting: Lighting = "",
        samples: int | None = None,
        resolution: Annotated[str, Field(description="such as 640x360")] = "",
    ) -> Content:
        """Make pictures of a house; of all of it (minutes) without rooms and cameras."""
        with _told_as_tools_do():
            path, into = self._files.there(house), self._files.place(folder)
            words = ["render", self._word(path), *_option("output", self._word(into))]
            words += [word for name in rooms for word in _option("room", name)]
            words += [word for name in cameras for word in _option("camera", name)]
            words += _option("quality", quality) + _option("lighting", lighting)
            words += _option("samples", samples) + _option("resolution", resolution)
            answer = await self._call(words, [path, into], ctx)
            shown = [self._files.root / name for name in answer.data["pictures"]]
            return _answered(answer.data, shown)

    async def check(self, house: House, ctx: Context) -> Content:
        """Say whether a house holds its certificate: nothing collides, every room is reached."""
        with _told_as_tools_do():
            path = self._files.there(house)
            answer = await self._call(["check", self._word(path)], [path], ctx)
            return _answered(answer.data)

    async def export(
        self, house: House, package: Package, output: NewFile, ctx: Context
    ) -> Content:
        """Write a house for other programs; ros and mujoco are folders."""
        with _told_as_tools_do():
            path, target = self._files.there(house), self._files.new(output)
            words = ["export", self._word(path), *_option("for", package)]
            words += _option("output", self._word(target))
            return _answered((await self._call(words, [path, target], ctx)).data)

    async def undo(self, house: House, ctx: Context) -> Content:
        """Take back the latest change of a house, whoever made it; redo does it again."""
        return await self._past("undo", house, ctx)

    async def redo(self, house: House, ctx: Context) -> Content:
        """Do again what undo took back last."""
        return await self._past("redo", house, ctx)

    async def history(self, house: House, ctx: Context, to: int | None = None) -> Content:
        """List what was done to a house; with a number of the list, go back to that state."""
        return await self._past("history", house, ctx, *_option("to", to))

    async def _past(self, verb: str, house: str, ctx: Context, *options: str) -> Content:
        with _told_as_tools_do():
            path = self._files.there(house)
            return _answered(
                (await self._call([verb, self._word(path), *options], [path], ctx)).data
            )

    async def diff(self, before: House, after: House, ctx: Context) -> Content:
        """Say what changed between two houses."""
        with _told_as_tools_do():
            paths = [self._files.there(before), self._files.there(after)]
            return _answered((await self._call(["diff", *map(self._word, paths)], paths, ctx)).data)

    def _word(self, path: Path) -> str:
        """A path as a word of a command line, relative to the root."""
        return f"./{self._files.name(path)}"

    def _sky(self, sky: str) -> str:
        """A sky's name; a picture is a file like any other."""
        return self._word(self._files.there(sky)) if Path(sky).suffix else sky

    async def _call(self, words: list[str], paths: Sequence[Path], ctx: Context) -> Answer:
        """Run a verb when nobody else works on these paths."""

        async def told(step: str, done: int, total: int) -> None:
            await ctx.report_progress(done, total, step)

        async with self._alone(paths):
            return await self._run(words, self._files.root, told)

    @asynccontextmanager
    async def _alone(self, paths: Sequence[Path]) -> AsyncIterator[None]:
        async with AsyncExitStack() as stack:
            for path in sorted(set(paths)):  # in one order: two calls never wait for one another
                await stack.enter_async_context(self._locks[path])
            yield


def _option(name: str, value: object) -> list[str]:
    """An option with its value, which is never taken for an option; nothing for no value."""
    return [] if value in ("", None) else [f"--{name}={value}"]


@contextmanager
def _told_as_tools_do() -> Iterator[None]:
    try:
        yield
    except ChordError as error:
        raise ToolError(error.sentence("agent")) from error


@contextmanager
def _picture() -> Iterator[Path]:
    """Where a picture can be drawn that is shown and not kept."""
    with tempfile.TemporaryDirectory(prefix="chord-usd-") as folder:
        yield Path(folder) / "picture.png"


def _answered(data: dict[str, Any], pictures: Sequence[Path] = ()) -> Content:
    shown = [_shown(path) for path in pictures[:MOST_PICTURES] if path.is_file()]
    return [TextContent(type="text", text=json.dumps(data, ensure_ascii=False)), *shown]


def _shown(path: Path) -> ImageContent:
    from PIL import Image

    drawn = io.BytesIO()
    with Image.open(path) as picture:
        picture.thumbnail((PICTURE_PX, PICTURE_PX))
        picture.save(drawn, format="PNG")
    data = base64.b64encode(drawn.getvalue()).decode()
    return ImageContent(type="image", data=data, mime_type="image/png")


def make_server(root: Path, run: RunVerb = run_verb) -> MCPServer:
    """A server of the tools. run: how a verb is run."""
    server = MCPServer(
        "chord-usd", version=__version__, instructions=INSTRUCTIONS, log_level="ERROR"
    )
    tools = HouseTools(AgentFiles(root), run)
    reads = ToolAnnotations(read_only_hint=True)
    adds = ToolAnnotations(destructive_hint=False)
    changes = ToolAnnotations(destructive_hint=True)
    kinds: list[tuple[Callable[..., Awaitable[Content]], ToolAnnotations]] = [
        (tools.list_files, reads), (tools.read_plan, adds), (tools.furnish, adds),
        (tools.look, reads), (tools.edit, changes), (tools.refurnish_room, changes),
        (tools.undo, changes), (tools.redo, changes), (tools.history, changes),
        (tools.diff, reads), (tools.check, reads), (tools.render, adds), (tools.export, adds),
    ]  # fmt: skip
    for tool, kind in kinds:
        server.add_tool(tool, annotations=kind)
    return server


def serve(root: Path) -> None:
    """Serve over standard input and output until the other side hangs up."""
    with redirect_stdout(console.stdout()):
        make_server(root).run("stdio")
