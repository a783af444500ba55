"""What the tests share: the command line as a user runs it, and a house to work on."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import jsonschema
import pytest
from hypothesis import settings

from chord_usd.base.runtime import confined, resident
from chord_usd.faces.commands.results import RESULTS, schema_of
from tests.core_packages import core_environment
from tests.forks import LoadedProgram, LoadedReaders

if TYPE_CHECKING:
    from chord_usd.base.scene.types import SceneGraph

if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    # Whoever runs the tests in the background of a script makes them, and all that they start, deaf
    # to the interrupts that some of them are about.
    signal.signal(signal.SIGINT, signal.default_int_handler)

# A process that outlives its test would serve the next one; test_worker.py starts its workers.
os.environ[resident.VARIABLE] = "0"


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Files with the mark `long` first; otherwise in their order."""
    items.sort(key=lambda item: item.get_closest_marker("long") is None)


RunCli = Callable[..., "subprocess.CompletedProcess[str]"]

TIMEOUT_S = 300

FRESH = confined._run

# The same examples every time: a change is judged by what it changes, not by luck.
settings.register_profile("steady", derandomize=True, deadline=None, max_examples=60)
settings.load_profile("steady")


@pytest.fixture(scope="session")
def loaded_program(tmp_path_factory: pytest.TempPathFactory) -> Iterator[LoadedProgram]:
    """The process that `run_cli` forks, in the environment of `_environment`."""
    program = LoadedProgram(_environment({}), tmp_path_factory.mktemp("streams"))
    yield program
    program.close()


@pytest.fixture(scope="session", autouse=True)
def loaded_readers(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Files of strangers are read in forks of a process, started for the first of them."""
    owner = os.getpid()
    started: list[LoadedReaders] = []

    def run(
        payload: bytes, wall_s: float, meanwhile: Callable[[], object] | None
    ) -> tuple[int, bytes]:
        if os.getpid() != owner:
            return FRESH(payload, wall_s, meanwhile)
        if not started or started[-1].has_ended:
            started.append(LoadedReaders(tmp_path_factory.mktemp("readers")))
        return started[-1].run(payload, wall_s, meanwhile)

    confined._run = run
    yield
    confined._run = FRESH
    for readers in started:
        readers.close()


@pytest.fixture(scope="module")
def fresh_readers() -> Iterator[None]:
    """Each file is read in a process that is started for it, as the program does."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(confined, "_run", FRESH)
        yield


@pytest.fixture(scope="session")
def run_cli(request: pytest.FixtureRequest) -> RunCli:
    """Runs `chord-usd ARGUMENTS` in another process and returns what it did.

    It runs as where no extra is installed: what the tests ask of it needs none. What --json prints
    has to follow the schema of its verb. The process is a fork of one that has loaded the program;
    one started afresh with `fresh`, and in another environment, which libraries read as they load.
    """

    def run(
        *arguments: object,
        cwd: Path | None = None,
        env: dict[str, str] | None = None,
        fresh: bool = False,
    ) -> subprocess.CompletedProcess[str]:
        words = [*map(str, arguments)]
        environment = _environment(env or {})
        loaded = None if fresh else request.getfixturevalue("loaded_program")
        if loaded and loaded.serves(environment):
            done = loaded.run(words, cwd, TIMEOUT_S)
        else:
            done = subprocess.run(
                [sys.executable, "-m", "chord_usd.cli", *words],
                cwd=cwd,
                env=environment,
                capture_output=True,
                text=True,
                timeout=TIMEOUT_S,
                check=False,
            )
        if "--json" in arguments and done.returncode in (0, 1):
            verb = next(
                (verb for verb in RESULTS if words[: len(verb.split())] == verb.split()), ""
            )
            jsonschema.validate(json.loads(done.stdout), schema_of(verb))
        return done

    return run


def _environment(more: dict[str, str]) -> dict[str, str]:
    environment = {**os.environ, **core_environment(), **more}
    environment.pop("PYTEST_CURRENT_TEST", None)
    return environment


@pytest.fixture(scope="session")
def extension(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The Blender extension's zip, built and validated by Blender's own tool."""
    bpy_folder = next(Path(folder) for folder in sys.path if (Path(folder) / "bpy").is_dir())
    tool = next(bpy_folder.glob("bpy/*/scripts/addons_core/bl_pkg/cli/blender_ext.py"))
    out = tmp_path_factory.mktemp("dist")
    source = Path(__file__).parents[1] / "blender_addon"
    command = [sys.executable, tool, "build", "--source-dir", source, "--output-dir", out]
    subprocess.run(command, check=True, capture_output=True)
    built = next(out.glob("chord_usd-*.zip"))
    subprocess.run([sys.executable, tool, "validate", built], check=True, capture_output=True)
    return built


@pytest.fixture(scope="session")
def run_in_blender(
    extension: Path, tmp_path_factory: pytest.TempPathFactory
) -> Callable[..., dict[str, Any]]:
    """Runs a script of tests/blender with the extension and returns what it tells."""

    def run(script: str, *arguments: Path) -> dict[str, Any]:
        path = Path(__file__).parent / "blender" / script
        folder = tmp_path_factory.mktemp("blender user")
        # Another Blender than the one of the environment, such as the oldest supported.
        blender = os.environ.get("BLENDER_PYTHON", sys.executable)
        command = [blender, path, folder, extension, sys.executable, *arguments]
        done = subprocess.run(
            # What a script removes by a relative path must not be in the checkout.
            command,
            cwd=folder,
            capture_output=True,
            text=True,
            timeout=2 * TIMEOUT_S,
            check=False,
        )
        lines = [line for line in done.stdout.splitlines() if line.startswith("RESULT")]
        assert lines, done.stdout[-2000:] + done.stderr[-2000:]
        return dict(json.loads(lines[0].removeprefix("RESULT")))

    return run


@pytest.fixture(scope="session")
def furnished_house() -> SceneGraph:
    """A house of a few rooms with all its furniture, read from a file."""
    from chord_usd.base.scene.chord_json import read_scene

    return read_scene(Path(__file__).parent / "fixtures" / "furnished_house.json")
