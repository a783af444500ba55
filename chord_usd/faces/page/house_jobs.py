"""What the jobs of a page do: command lines of the verbs, and what is noted of their answers."""

from __future__ import annotations

import json
import re
import shutil
from collections.abc import Awaitable, Callable, Iterator, Sequence
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import anyio

from chord_usd.base.errors import ChordError
from chord_usd.base.runtime.archives import pack_folder
from chord_usd.base.runtime.files import hash_file, link_or_copy
from chord_usd.base.runtime.house_history import Deed, go_to, read_history, recorded, redo, undo
from chord_usd.base.runtime.verb_calls import Answer, ReportProgress
from chord_usd.base.scene.settings import offered_by, words_of
from chord_usd.faces.page.asked import PACKS, QUALITIES
from chord_usd.faces.page.job_queue import Job
from chord_usd.faces.page.kept_houses import EDITS, STAGE, KeptHouses, Record
from chord_usd.faces.page.piece_edits import carry_edits
from chord_usd.faces.page.swapped_models import (
    OFFERED,
    bring_model,
    is_name,
    note_offered,
    piece_layer,
)
from chord_usd.faces.page.uploads import refuse_full_disk

Submit = Callable[[str, str, dict[str, Any]], object]
RunVerb = Callable[[Sequence[str], Path, ReportProgress], Awaitable[Answer]]

VIEW = "view.glb"
"""Of a version as it was furnished."""
VIEWS = "views"
CHANGES = ("say", "refurnish", "view")
"""Jobs that change a version in its place."""

MOST_MODELS = 9

CAN_SAY = find_spec("chord_usd.faces.commands.edit") is not None
"""Whether houses can be changed by sentences here."""

_ROOM = re.compile(r"/House/Rooms/(?:Storey_\d+/)?(?!Storey_\d+$)\w+")


class HouseJobs:
    """Does the jobs. Whatever is written goes into folders that no finished version has."""

    def __init__(self, houses: KeptHouses, run: RunVerb) -> None:
        self._houses, self._run = houses, run
        self.submit: Submit = lambda house, kind, given: None
        """What asks for a further job: a house can be seen before its certificate is there."""
        self.kinds: dict[str, Callable[[Job], Awaitable[dict[str, Any]]]] = {
            "read": self._read,
            "divide": self._divide,
            "furnish": self._furnish,
            "refurnish": self._refurnish,
            **({"say": self._say} if CAN_SAY else {}),
            "models": self._models,
            "swap": self._swap,
            "view": self._view,
            "check": self._check,
            "render": self._render,
            "pack": self._pack,
        }

    async def do(self, job: Job) -> dict[str, Any]:
        """Do a job; returns its answer. Raises ChordError."""
        refuse_full_disk(self._houses.root)
        return await self.kinds[job.kind](job)

    async def _read(self, job: Job) -> dict[str, Any]:
        """The drawing or the text becomes a plan; --scale, --part and --seed as given."""
        record, folder = self._houses.get(job.house), self._houses.folder(job.house)
        number = int(record["plan"]) + 1
        target = self._houses.plan_path(job.house, number)
        target.parent.mkdir(exist_ok=True)
        word, drawing = self._houses.word, folder / "drawing.png"
        if record["source"]:
            words = ["plan", "read", word(folder / record["source"])]
            words += [f"--drawing={word(drawing)}"] if record["source"] != "source.json" else []
            words += _option("scale", job.given.get("scale"))
            words += _option("part", job.given.get("part"))
        else:
            words = ["plan", "from-text", _no_option(record["text"])]
            words += _option("seed", job.given.get("seed"))
        answer = await self._call(job, [*words, f"--output={word(target)}"])

        def change(kept: Record) -> None:
            kept.update(plan=number, reading=answer.data, drawing=answer.data.get("drawing"))

        self._houses.update(job.house, change)
        return answer.data

    async def _divide(self, job: Job) -> dict[str, Any]:
        """The current plan, outer walls only, gets rooms; --text and --seed as given."""
        before = int(self._houses.get(job.house)["plan"])
        target = self._houses.plan_path(job.house, before + 1)
        outline = self._houses.word(self._houses.plan_path(job.house, before))
        words = ["plan", "from-outline", outline, *_option("text", job.given.get("text"))]
        words += _option("seed", job.given.get("seed"))
        answer = await self._call(job, [*words, f"--output={self._houses.word(target)}"])
        self._houses.update(
            job.house, lambda kept: kept.update(plan=before + 1, reading=answer.data)
        )
        return answer.data

    async def _furnish(self, job: Job) -> dict[str, Any]:
        """The current plan becomes a version of its own."""
        given = job.given
        if not self._houses.get(job.house)["plan"]:
            await self._read(job)
        plan = int(self._houses.get(job.house)["plan"])
        storeys = [(job.house, plan), *self._houses.plans_above(job.house)]
        with self._version(job) as (number, folder):
            plans = [self._houses.word(self._houses.plan_path(*storey)) for storey in storeys]
            words = ["generate", *plans, "--no-check"]
            words += [f"--output={self._houses.word(folder / 'house' / STAGE)}"]
            words += words_of({row.name: given.get(row.name) for row in offered_by("page")})
            answer = await self._call(job, [*words, self._view_word(folder)])
            rooms = _rooms_in(folder / VIEW)
            label = f"seed {given.get('seed') or 0}, {answer.data.get('style') or 'house'}"
            summary = _told(answer.data) | _levels(storeys, answer.data)
            self._keep(job, number, label, plan, 0, rooms, summary)
        self.submit(job.house, "check", {"version": number})
        return {"version": number, **answer.data}

    async def _refurnish(self, job: Job) -> dict[str, Any]:
        """One room of a version again; changes by hand of other rooms stay."""
        given = job.given
        words = [*_option("room", given["room"]), *_option("with", given.get("with"))]
        words += _option("without", given.get("without"))
        words += [word for name in given.get("keep") or () for word in _option("keep", name)]
        words += _option("seed", given.get("seed")) + _option("style", given.get("style"))

        def carry(house: Path, data: Record) -> None:
            carry_edits(house, room=data.get("room", given["room"]))

        return await self._change(job, "regenerate", words, carry)

    async def _say(self, job: Job) -> dict[str, Any]:
        """A version changed as a sentence says, or a question answered."""
        words = [_no_option(str(job.given["sentence"]))]
        words += ["--force"] if job.given.get("force") else []
        return await self._change(
            job, "edit", words, lambda house, data: carry_edits(house, touched=data["taken_over"])
        )

    async def _change(
        self, job: Job, verb: str, words: Sequence[str], carry: Callable[[Path, Record], None]
    ) -> dict[str, Any]:
        """A version changed in its place by a verb, which its history keeps, and seen again.

        carry: leaves the changes by hand that still mean something. Where the view cannot be made,
        or the job is cancelled, the house is as it was.
        """
        number = job.given["version"]
        folder = self._houses.version_folder(job.house, number)
        house, stage = folder / "house", folder / "house" / STAGE
        keep_view(folder)
        view = folder / VIEWS / f"{job.id}.glb"
        line = [verb, self._houses.word(stage), *words]
        line += [f"--{name}={self._houses.word(at)}" for name, at in
                 (("output", stage), ("view", view), ("edits", house / EDITS))
                 if name != "edits" or at.is_file()]  # fmt: skip
        before = max(read_history(stage).number, 1)
        try:
            with recorded(stage, Deed(verb, str(job.given.get("sentence") or words[0]))):
                answer = await self._call(job, line)
                if not answer.data.get("written", True):
                    return {"version": number, **answer.data}
                if not answer.data.get("answer"):  # a step along the history is whole
                    carry(house, answer.data)
            view.replace(folder / view_of(folder))
        except BaseException:
            view.unlink(missing_ok=True)
            if read_history(stage).number > before:
                undo(stage)
            raise
        self._show(job.house, number)
        self.submit(job.house, "check", {"version": number})
        return {"version": number, **answer.data}

    async def _view(self, job: Job) -> dict[str, Any]:
        """A version that went back to a state of which no view is kept, seen again."""
        folder = self._houses.version_folder(job.house, job.given.get("version"))
        words = ["export", self._houses.word(folder / "house" / STAGE), "--for=gltf"]
        view = folder / VIEWS / f"{job.id}.glb"
        await self._call(job, [*words, f"--output={self._houses.word(view)}"])
        view.replace(folder / view_of(folder))
        self._show(job.house, job.given["version"])
        return {}

    def _show(self, house: str, number: object) -> None:
        """Note which view a version has now, and that its changes by hand are other ones."""
        folder = self._houses.version_folder(house, number)
        view = view_of(folder)
        rooms = _rooms_in(folder / view)

        def change(version: Record) -> None:
            version.update(view=view, rooms=rooms, revision=version.get("revision", 0) + 1)

        self._houses.note(house, number, change)

    def put_back(self, house: str, number: int, way: str, to: int | None) -> None:
        """Undo or redo a change of a version, or go to any that its history has.

        Raises ChordError for a version that is being changed, and what house_history.undo raises.
        """
        folder = self._houses.version_folder(house, number)
        stage = folder / "house" / STAGE
        keep_view(folder)
        ways = {"undo": undo, "redo": redo, "to": lambda house: go_to(house, to or 0)}
        if way not in ways:
            raise ChordError("there is no such way", expected=f"one of {', '.join(ways)}")
        ways[way](stage)
        if (folder / view_of(folder)).is_file():
            self._show(house, number)
        else:
            self.submit(house, "view", {"version": number})

    def _keep(
        self,
        job: Job,
        number: int,
        label: str,
        plan: object,
        of: int,
        rooms: object,
        summary: Record,
    ) -> None:
        """List a version with its house. of: the version that it was made from, 0 for none."""
        version = {"number": number, "label": label, "plan": plan, "of": of, "rooms": rooms}
        self._houses.add_version(job.house, {**version, **summary})

    def _view_word(self, folder: Path) -> str:
        return f"--view={self._houses.word(folder / VIEW)}"

    async def _models(self, job: Job) -> dict[str, Any]:
        """Models that could take the place of a piece, with pictures."""
        given, folder = job.given, self._houses.root / OFFERED
        words = ["assets", "nearest", _no_option(str(given["category"]))]
        words += [*_option("size", given["size"]), f"--count={MOST_MODELS}"]
        answer = await self._call(job, [*words, f"--pictures={self._houses.word(folder)}"])
        return {"models": note_offered(folder, answer.data["assets"])}

    async def _swap(self, job: Job) -> dict[str, Any]:
        """A model that was offered comes beside the house, in a colour, to be seen in the view."""
        given = job.given
        folder = self._houses.version_folder(job.house, given.get("version"))
        usd = bring_model(self._houses.root / OFFERED, given["model"], folder / "house")
        colour = given.get("colour") or ""
        if colour and not is_name(colour):
            raise ChordError("that is no colour")
        name = f"{Path(usd).parent.name}-{colour}"
        target = folder / "models" / f"{name}.glb"
        if not target.is_file():
            # Beside the house: a stage's files lie in its own folder.
            stage = folder / "house" / f"piece-{job.id}.usda"
            target.parent.mkdir(exist_ok=True)
            try:
                stage.write_text(piece_layer(usd, colour))
                words = ["export", self._houses.word(stage), "--for=gltf"]
                await self._call(job, [*words, f"--output={self._houses.word(target)}"])
            finally:
                stage.unlink(missing_ok=True)
        return {"usd": usd, "view": target.name, "model": given["model"], "colour": colour}

    async def _check(self, job: Job) -> dict[str, Any]:
        stage = self._houses.stage(job.house, job.given.get("version"))
        state = self._houses.state(job.house, job.given["version"])
        answer = await self._call(job, ["check", self._houses.word(stage)])

        def change(version: Record) -> None:
            version.update(certificate=answer.data, certified=state)

        self._houses.note(job.house, job.given["version"], change)
        return answer.data

    async def _render(self, job: Job) -> dict[str, Any]:
        """One camera, into a folder of its own: pictures of other settings stay."""
        given = job.given
        quality, size = QUALITIES[given.get("quality") or "draft"]
        folder = self._houses.version_folder(job.house, given.get("version"))
        stage = self._houses.stage(job.house, given["version"])
        target = folder / "pictures" / job.id
        words = ["render", self._houses.word(stage), f"--output={self._houses.word(target)}"]
        words += _option("camera", given["camera"]) + _option("lighting", given.get("lighting"))
        words += [f"--quality={quality}", f"--resolution={size}"]
        try:
            answer = await self._call(job, words)
        except BaseException:
            shutil.rmtree(target, ignore_errors=True)
            raise
        names = [f"{job.id}/{Path(path).name}" for path in answer.data["pictures"]]

        def change(version: Record) -> None:
            version["pictures"] += names

        self._houses.note(job.house, given["version"], change)
        return {"pictures": names}

    async def _pack(self, job: Job) -> dict[str, Any]:
        """A file to take away. Made again each time: the house may have been changed since."""
        kind = job.given["for"]
        folder = self._houses.version_folder(job.house, job.given.get("version"))
        stage = self._houses.stage(job.house, job.given["version"])
        made = folder / "packs" / job.id
        made.mkdir(parents=True)
        try:
            if kind == "usda":
                await anyio.to_thread.run_sync(
                    pack_folder, stage.parent, made / PACKS[kind], "house"
                )
            else:
                suffix = Path(PACKS[kind]).suffix
                target = made / ("house" if suffix == ".zip" else PACKS[kind])
                words = ["export", self._houses.word(stage), f"--for={kind}"]
                await self._call(job, [*words, f"--output={self._houses.word(target)}"])
                if suffix == ".zip":
                    await anyio.to_thread.run_sync(pack_folder, target, made / PACKS[kind], kind)
            (made / PACKS[kind]).replace(made.parent / PACKS[kind])
        finally:
            shutil.rmtree(made, ignore_errors=True)

        def change(version: Record) -> None:
            version["packs"] = sorted({*version["packs"], PACKS[kind]})

        self._houses.note(job.house, job.given["version"], change)
        return {"file": PACKS[kind]}

    @contextmanager
    def _version(self, job: Job) -> Iterator[tuple[int, Path]]:
        """A new version's number and folder, which goes again when the job breaks off."""
        number, folder = self._houses.new_version(job.house)
        (folder / "house").mkdir()
        try:
            yield number, folder
        except BaseException:
            shutil.rmtree(folder, ignore_errors=True)
            raise

    async def _call(self, job: Job, words: Sequence[str]) -> Answer:
        async def told(step: str, done: int, total: int) -> None:
            job.step, job.done, job.total = step, done, max(total, 1)

        await told(words[0], 0, 1)
        return await self._run(words, self._houses.root, told)


def view_of(folder: Path) -> str:
    """Where the view of a version is, as its stage is now, below the version's folder."""
    return f"{VIEWS}/{hash_file(folder / 'house' / STAGE)[:16]}.glb"


def keep_view(folder: Path) -> None:
    """Let the first view of a version be found when its house is again as it was furnished."""
    if not (folder / VIEWS).exists():
        (folder / VIEWS).mkdir()
        link_or_copy(folder / VIEW, folder / view_of(folder))


def _option(name: str, value: object) -> list[str]:
    """An option with its value, which is never taken for an option; nothing for no value."""
    return [] if value in ("", None) else [f"--{name}={value}"]


def _no_option(text: str) -> str:
    """A text that stands alone on a command line, where a dash would begin an option."""
    return text.lstrip("- ") or "a house"


def _told(data: dict[str, Any]) -> Record:
    """What of a verb's answer is kept of a version."""
    return {
        "style": data.get("style", ""),
        "furniture": data.get("furniture"),
        "warnings": data.get("warnings", []),
        "left_out": data.get("left_out", []),
        "certificate": data.get("certificate"),
    }


def _levels(storeys: Sequence[tuple[str, int]], data: dict[str, Any]) -> Record:
    """The storeys of a house of several: whose plan each is, and where it lies."""
    levels = data.get("storeys", ())
    if len(storeys) < 2 or len(levels) != len(storeys):
        return {}
    kept = ("name", "elevation_m", "shift_m")
    rows = [
        {"house": house, "plan": plan, **{key: level[key] for key in kept}}
        for (house, plan), level in zip(storeys, levels, strict=True)
    ]
    return {"storeys": rows}


def _rooms_in(view: Path) -> list[str]:
    """Names of the rooms of a GLB: of the nodes whose path is a room's."""
    with view.open("rb") as file:
        head = file.read(20)
        document = json.loads(file.read(int.from_bytes(head[12:16], "little")))
    paths = (node.get("extras", {}).get("path", "") for node in document.get("nodes", ()))
    return [path.rsplit("/", 1)[-1] for path in paths if _ROOM.fullmatch(path)]
