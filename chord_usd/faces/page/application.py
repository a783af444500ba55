"""The server of the page: what it answers, and to whom."""

from __future__ import annotations

import re
import shutil
from collections.abc import AsyncIterator, Awaitable, Callable, Iterator
from contextlib import asynccontextmanager, contextmanager
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

import anyio
from starlette.applications import Starlette
from starlette.background import BackgroundTask
from starlette.middleware import Middleware
from starlette.requests import ClientDisconnect, Request
from starlette.responses import FileResponse, JSONResponse, Response
from starlette.routing import Route

from chord_usd.base.errors import ChordError, DiskFullError
from chord_usd.base.runtime.extras import three_module
from chord_usd.base.runtime.warm_calls import WarmVerbs
from chord_usd.base.scene.limits import PARTS
from chord_usd.base.scene.settings import form_field, offered_by
from chord_usd.faces.page.asked import LONGEST_TEXT, PACKS, fields_of, given_of, parts_of
from chord_usd.faces.page.gate import Gate, refused
from chord_usd.faces.page.house_jobs import CAN_SAY, CHANGES, VIEW, VIEWS, HouseJobs, RunVerb
from chord_usd.faces.page.job_queue import OVER, BusyError, Job, JobQueue
from chord_usd.faces.page.kept_houses import ChangedError, KeptHouses, NotThereError, Record
from chord_usd.faces.page.piece_edits import read_edits, write_edits
from chord_usd.faces.page.swapped_models import OFFERED, is_name
from chord_usd.faces.page.uploads import (
    PLAN_SUFFIXES,
    plan_suffix,
    receive,
    refuse_full_disk,
    refuse_size,
    shown_name,
)

STATIC = Path(__file__).with_name("static")

_TYPES = {".html": "text/html", ".css": "text/css", ".js": "text/javascript",
          ".svg": "image/svg+xml"}  # fmt: skip
_PICTURE = re.compile(r"[0-9a-f]{12}/[\w.-]{1,80}\.png")
_VIEW = re.compile(r"[0-9a-f]{16}\.glb")

Answered = Callable[[Request], Awaitable[Response]]


def make_application(
    root: Path, *, token: str, host: str = "127.0.0.1", run: RunVerb | None = None
) -> Starlette:
    """The page over the houses below root. Raises MissingExtraError.

    token: what each request must have. run: how a verb is run; by default in a process that is
    started when the page is opened.
    """
    page = _Page(KeptHouses(root), run)
    routes = [
        Route("/", page.index),
        Route("/page/three.js", page.three),
        Route("/page/{name}", page.static),
        Route("/api/choices", page.choices),
        Route("/api/houses", told(page.houses), methods=["GET"]),
        Route("/api/houses", told(page.new_house), methods=["POST"]),
        Route("/api/houses/{house}", told(page.house), methods=["GET"]),
        Route("/api/houses/{house}", told(page.change_house), methods=["PATCH"]),
        Route("/api/houses/{house}", told(page.delete_house), methods=["DELETE"]),
        Route("/api/houses/{house}/plan", told(page.plan), methods=["GET"]),
        Route("/api/houses/{house}/plan", told(page.put_plan), methods=["PUT"]),
        Route("/api/houses/{house}/jobs", told(page.new_job), methods=["POST"]),
        Route("/api/houses/{house}/drawing.png", told(page.drawing)),
        Route("/api/houses/{house}/versions/{number:int}/edits", told(page.edits), methods=["GET"]),
        Route(
            "/api/houses/{house}/versions/{number:int}/edits", told(page.put_edits), methods=["PUT"]
        ),
        Route(
            "/api/houses/{house}/versions/{number:int}/past", told(page.put_back), methods=["POST"]
        ),
        Route("/api/houses/{house}/versions/{number:int}/{kind}/{name:path}", told(page.file)),
        Route("/api/models/{name}.png", told(page.model_picture)),
        Route("/api/jobs/{job}", told(page.cancel), methods=["DELETE"]),
        Route("/api/jobs/{job}/again", told(page.again), methods=["POST"]),
    ]
    return Starlette(
        routes=routes,
        middleware=[Middleware(Gate, host=host, token=token)],
        lifespan=page.life,
    )


_STATUS = {NotThereError: 404, ChangedError: 409, DiskFullError: 507, BusyError: 503}
"""Of HTTP, by the kind of error; UploadError has its own."""


def told(answer: Answered) -> Answered:
    """The same, with errors as sentences and the status that fits."""

    async def telling(request: Request) -> Response:
        try:
            return await answer(request)
        except ChordError as error:
            kinds = (kind for kind in _STATUS if isinstance(error, kind))
            status = getattr(error, "status", _STATUS.get(next(kinds, ChordError), 400))
            more = {"retry-after": "60"} if status == 503 else None
            return refused(error.sentence("page"), status, more)
        except ClientDisconnect:
            return Response(status_code=400)

    return telling


class _Page:
    """The answers."""

    def __init__(self, houses: KeptHouses, run: RunVerb | None) -> None:
        self._houses = houses
        run = run or WarmVerbs()
        self._warm = run if isinstance(run, WarmVerbs) else None
        self._work = HouseJobs(houses, run)
        self._jobs = JobQueue(houses.root / ".jobs", self._work.do)
        self._work.submit = partial(self._jobs.submit, is_follow_up=True)
        self._three = three_module()

    @asynccontextmanager
    async def life(self, _app: Starlette) -> AsyncIterator[None]:
        """From the first request to the last."""
        await self._jobs.start()
        try:
            yield
        finally:
            await self._jobs.stop()
            if self._warm:
                await self._warm.end()

    # what the page is made of -------------------------------------------------------------------

    async def index(self, _request: Request) -> Response:
        return self._soon(_static("index.html"))

    def _soon(self, answer: Response) -> Response:
        """The answer; once it is sent, what furnishes houses is loaded, which soon is asked for."""
        if self._warm:
            answer.background = BackgroundTask(self._warm.warm, self._houses.root)
        return answer

    async def static(self, request: Request) -> Response:
        return _static(request.path_params["name"])

    async def three(self, _request: Request) -> Response:
        # It changes with the wheel only, and is by far the largest part of the page.
        kept = {"cache-control": "private, max-age=86400"}
        return FileResponse(self._three, media_type="text/javascript", headers=kept)

    async def choices(self, _request: Request) -> Response:
        return _json(
            {
                "options": [form_field(option) for option in offered_by("page")],
                "packs": PACKS,
                "canSay": CAN_SAY,
                "suffixes": PLAN_SUFFIXES,
            }
        )

    # houses -------------------------------------------------------------------------------------

    async def houses(self, _request: Request) -> Response:
        return _json({"houses": self._houses.listed()})

    async def new_house(self, request: Request) -> Response:
        """A plan as the body, called ?name=; or {"text": ...}; or {"below": house, "part": N}, the
        part of that house's file that is the storey above. Read at once, as a job.

        ?below=: the house whose next storey a plan is.
        """
        refuse_full_disk(self._houses.root)
        self._jobs.require_place()
        below = request.query_params.get("below", "")
        if below:
            self._houses.folder(below)
        if request.headers.get("content-type", "").startswith("application/json"):
            body = await fields_of(request, {"text": str, "below": str, "part": int})
            if body.get("below"):
                return self._storey(body["below"], body.get("part"))
            text = body.get("text") or ""
            if not text.strip() or len(text) > LONGEST_TEXT or "\0" in text:
                raise ChordError("a text is needed", expected=f"1 to {LONGEST_TEXT} characters")
            with self._kept_if_read(text, "", below, {}, text=" ".join(text.split())) as asked:
                pass
            return asked.answer
        name = request.query_params.get("name", "")
        suffix = plan_suffix(name)
        refuse_size(request.headers.get("content-length"))
        with self._kept_if_read(name.rpartition(".")[0] or name, suffix, below, {}) as asked:
            await receive(parts_of(request), asked.source)
        return asked.answer

    def _storey(self, below: str, part: int | None) -> Response:
        """Another part of the file of a house, as the storey above it."""
        source = self._houses.get(self._houses.ground_of(below))
        if not source["source"] or part is None or not 1 <= part <= PARTS[1]:
            raise ChordError("that is no part of a file", expected=f"1 to {PARTS[1]}, of a plan")
        name, suffix = f"{source['name']} {part}", Path(source["source"]).suffix
        with self._kept_if_read(name, suffix, below, {"part": part}) as asked:
            shutil.copyfile(self._houses.folder(source["id"]) / source["source"], asked.source)
        return asked.answer

    @contextmanager
    def _kept_if_read(
        self, name: str, suffix: str, below: str, given: Record, text: str = ""
    ) -> Iterator[_Asked]:
        """A new house, while its file is written; then its reading is queued.

        Without a place in the queue, or a whole file, nothing of it stays.
        """
        record = self._houses.new(name, suffix, text)
        house = record["id"]
        asked = _Asked(self._houses.folder(house) / record["source"])
        try:
            yield asked
            job = self._jobs.submit(house, "read", given)
            if below:
                self._houses.put_above(below, house)
            asked.answer = _json({**self._shown(house), "job": job.id}, 201)
        except BaseException:
            self._jobs.cancel_of(house)
            self._houses.delete(house)
            raise

    async def house(self, request: Request) -> Response:
        return _json(self._shown(request.path_params["house"]))

    async def change_house(self, request: Request) -> Response:
        """Another name, or another version to show."""
        house = request.path_params["house"]
        body = await fields_of(request, {"name": str, "shown": int})
        if body.get("shown") is not None:
            self._houses.version_folder(house, body["shown"])

        def change(record: Record) -> None:
            if body.get("name"):
                record["name"] = shown_name(body["name"])
            if body.get("shown") is not None:
                record["shown"] = body["shown"]

        self._houses.update(house, change)
        return _json(self._shown(house))

    async def delete_house(self, request: Request) -> Response:
        house = request.path_params["house"]
        self._houses.folder(house)
        self._jobs.cancel_of(house)
        self._houses.delete(house)
        return _json({})

    async def plan(self, request: Request) -> Response:
        """The current plan, or an earlier one, ?number=."""
        house, asked = request.path_params["house"], request.query_params.get("number", "")
        number = int(asked[:9]) if asked.isdecimal() else self._houses.get(house)["plan"]
        return _json({"number": number, "plan": self._houses.plan(house, number)})

    async def put_plan(self, request: Request) -> Response:
        body = await fields_of(request, {"base": int, "plan": dict, "drawing": dict})
        house = request.path_params["house"]
        frame = body.get("drawing")
        number = self._houses.put_plan(house, body.get("plan"), body.get("base"), frame)
        return self._soon(_json({"number": number}))

    async def drawing(self, request: Request) -> Response:
        return _file(self._houses.folder(request.path_params["house"]) / "drawing.png")

    async def edits(self, request: Request) -> Response:
        """What was moved, deleted and locked in a version."""
        folder, revision = self._edited(request)
        return _json({"revision": revision, "edits": read_edits(folder)})

    async def put_edits(self, request: Request) -> Response:
        """Keep changes; base: the revision that they were made of."""
        body = await fields_of(request, {"base": int, "edits": dict})
        folder, revision = self._edited(request)
        if body.get("base") != revision:
            raise ChangedError("the house was changed in another tab", try_="load the page again")
        write_edits(folder, body.get("edits"))

        def change(version: Record) -> None:
            version["revision"] = revision + 1

        house, number = request.path_params["house"], request.path_params["number"]
        self._houses.note(house, number, change)
        return _json({"revision": revision + 1})

    async def put_back(self, request: Request) -> Response:
        """Undo or redo a change of a version, or go to one of its history."""
        body = await fields_of(request, {"way": str, "to": int})
        house, number = request.path_params["house"], request.path_params["number"]
        at_work = (job for job in self._jobs.of(house) if job.state not in OVER)
        if any(job.kind in CHANGES for job in at_work):
            raise ChangedError("a job is changing the house", try_="again when it is done")
        way = (house, number, body.get("way") or "", body.get("to"))
        await anyio.to_thread.run_sync(self._work.put_back, *way)
        return _json(self._shown(house))

    def _edited(self, request: Request) -> tuple[Path, int]:
        """The folder of a version's house, and how often it was changed by hand."""
        house, number = request.path_params["house"], request.path_params["number"]
        folder = self._houses.version_folder(house, number) / "house"
        versions = self._houses.get(house)["versions"]
        return folder, next(v.get("revision", 0) for v in versions if v["number"] == number)

    async def file(self, request: Request) -> Response:
        """The view, a picture or a package of a version."""
        house, number = request.path_params["house"], request.path_params["number"]
        kind, name = request.path_params["kind"], request.path_params["name"]
        folder = self._houses.version_folder(house, number)
        if kind == "view" and name == VIEW:
            return _file(folder / VIEW)
        if kind == "views" and _VIEW.fullmatch(name):
            return _file(folder / VIEWS / name)
        if kind == "pictures" and _PICTURE.fullmatch(name):
            return _file(folder / "pictures" / name)
        if kind == "models" and is_name(name) and name.endswith(".glb"):
            return _file(folder / "models" / name)
        if kind == "packs" and name in PACKS.values():
            called = self._houses.get(house)["name"]
            stem, _, suffix = name.partition(".")
            return _file(folder / "packs" / name, f"{called}{stem.removeprefix('house')}.{suffix}")
        raise NotThereError("there is no such file")

    async def model_picture(self, request: Request) -> Response:
        """Of a model that was offered for a piece."""
        name = request.path_params["name"]
        if not is_name(name):
            raise NotThereError("there is no such file")
        return _file(self._houses.root / OFFERED / f"{name}.png")

    # jobs ---------------------------------------------------------------------------------------

    async def new_job(self, request: Request) -> Response:
        house = request.path_params["house"]
        body = await fields_of(request, {"kind": str, "given": dict})
        self._houses.folder(house)
        kind = body.get("kind") or ""
        if kind not in self._work.kinds:
            raise ChordError(
                "there is no such job", expected=f"one of {', '.join(self._work.kinds)}"
            )
        given = given_of(kind, body.get("given") or {})
        return _json(self._told(self._jobs.submit(house, kind, given)))

    async def cancel(self, request: Request) -> Response:
        job = self._job(request)
        self._jobs.cancel(job)
        return _json(self._told(job))

    async def again(self, request: Request) -> Response:
        """A job that is over, asked for once more: what ended with a server goes on so."""
        job = self._job(request)
        if job.state not in OVER:
            raise ChordError("the job is not over")
        self._houses.folder(job.house)
        return _json(self._told(self._jobs.submit(job.house, job.kind, job.given)))

    def _job(self, request: Request) -> Job:
        job = self._jobs.get(request.path_params["job"])
        if job is None:
            raise NotThereError("there is no such job")
        return job

    def _told(self, job: Job) -> Record:
        return {**job.told(), "ahead": self._jobs.ahead_of(job)}

    def _shown(self, house: str) -> Record:
        record = self._houses.get(house)
        storeys = [
            {"id": storey, "name": self._houses.get(storey)["name"]}
            for storey in self._houses.storeys(house)
        ]
        jobs = [self._told(job) for job in self._jobs.of(house)[-20:]]
        return {**record, "storeys": storeys, "jobs": jobs, "past": self._houses.past(record)}


@dataclass
class _Asked:
    """A house that is asked for."""

    source: Path
    """The file that its plan is written to."""
    answer: Response = field(default_factory=Response)


def _static(name: str) -> Response:
    file = STATIC / name
    if file.parent != STATIC or file.suffix not in _TYPES or not file.is_file():
        return refused("there is no such file", 404)
    return FileResponse(file, media_type=_TYPES[file.suffix], headers={"cache-control": "no-cache"})


def _file(path: Path, name: str | None = None) -> Response:
    if not path.is_file():
        raise NotThereError("there is no such file")
    return FileResponse(path, filename=name, headers={"cache-control": "private, no-cache"})


def _json(data: object, status: int = 200) -> Response:
    return JSONResponse(data, status, headers={"cache-control": "no-store"})
