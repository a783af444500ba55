"""Listening: one server on a folder, on a port that is free, until it is told to end."""

from __future__ import annotations

import asyncio
import contextlib
import fcntl
import os
import secrets
import signal
import socket
from collections.abc import Callable, Iterator
from pathlib import Path

import uvicorn

from chord_usd.base.errors import ChordError, OutputError, reason_of
from chord_usd.faces.page.addresses import shown_address
from chord_usd.faces.page.application import make_application
from chord_usd.faces.page.timed_protocol import TimedProtocol

LOCK = ".server.lock"
SHUTDOWN_S = 5


def serve_page(root: Path, host: str, port: int, say: Callable[[str], None]) -> None:
    """Serve the houses below root until SIGINT or SIGTERM.

    say: is told the address. Raises OutputError for a folder that another server has or that cannot
    be written, ChordError for a port that is taken.
    """
    with _alone(root), _listening(host, port) as listener:
        token = secrets.token_urlsafe(24)
        application = make_application(root, host=host, token=token)
        # Python writes to the page's folder only; what uvicorn logs would hold the token.
        config = uvicorn.Config(
            application,
            http=TimedProtocol,
            log_config=None,
            access_log=False,
            server_header=False,
            lifespan="on",
            timeout_graceful_shutdown=SHUTDOWN_S,
        )
        say(f"http://{shown_address(host)}:{listener.getsockname()[1]}/?token={token}")
        asyncio.run(_serve(_Server(config), listener))


class _Server(uvicorn.Server):
    """Leaves signals alone: a server that is told to end has done its work, which is no error."""

    @contextlib.contextmanager
    def capture_signals(self) -> Iterator[None]:
        yield


async def _serve(server: uvicorn.Server, listener: socket.socket) -> None:
    def end() -> None:
        server.should_exit = True

    loop = asyncio.get_running_loop()
    for number in (signal.SIGINT, signal.SIGTERM):
        loop.add_signal_handler(number, end)
    await server.serve([listener])


@contextlib.contextmanager
def _alone(root: Path) -> Iterator[None]:
    """The folder, for this server only: two would give houses to one another's jobs."""
    try:
        root.mkdir(parents=True, exist_ok=True)
        handle = os.open(root / LOCK, os.O_RDWR | os.O_CREAT, 0o600)
    except OSError as error:
        raise OutputError(f"cannot be written to ({reason_of(error)})", where=str(root)) from error
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        raise OutputError(
            "another server has this folder", where=str(root), try_="another --root"
        ) from None
    else:
        yield
    finally:
        os.close(handle)


@contextlib.contextmanager
def _listening(host: str, port: int) -> Iterator[socket.socket]:
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    with socket.socket(family, socket.SOCK_STREAM) as listener:
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            listener.bind((host, port))
        except OSError as error:
            raise ChordError(
                f"cannot listen on {host}:{port} ({reason_of(error)})",
                where="--port",
                expected="a free port",
                try_="--port 0, which takes any",
            ) from error
        listener.listen(128)
        yield listener
