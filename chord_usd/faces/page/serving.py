"""Listening: one server on a folder, on a port that is free, until a signal ends it."""

from __future__ import annotations

import asyncio
import contextlib
import fcntl
import ipaddress
import os
import secrets
import signal
import socket
import struct
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import h11
import uvicorn
from uvicorn.protocols.http.h11_impl import H11Protocol

from chord_usd.base.errors import ChordError, OutputError, reason_of
from chord_usd.faces.page.application import make_application

LOCK = ".server.lock"
SHUTDOWN_S = 5


def serve_page(root: Path, host: str, port: int, say: Callable[[str], None]) -> None:
    """Serve the houses below root until SIGINT or SIGTERM.

    say: takes the address. Raises OutputError for a folder that another server has or that cannot
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
    """Leaves signals alone: a server that a signal ends has done its work, which is no error."""

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
            "another server has this folder", where=str(root), try_="another <root>"
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
                where="<port>",
                expected="a free port",
                try_="<port=0>, which takes any",
            ) from error
        listener.listen(128)
        yield listener


# Addresses of this machine, as a browser elsewhere asks for them ---------------------------------

_SIOCGIFADDR = 0x8915
"""The request of Linux for the IPv4 address of an interface."""


def shown_address(host: str) -> str:
    """The host part of the address of a server, as other machines can use it.

    host: the interface that it listens on. For all interfaces (0.0.0.0, ::) it is the IPv4 address
    of the first that is not loopback, else that of loopback. Nothing is sent or looked up.
    """
    if ipaddress.ip_address(host).is_unspecified:
        reachable = [
            address for address in _addresses() if not ipaddress.ip_address(address).is_loopback
        ]
        host = (reachable or ["127.0.0.1"])[0]
    return f"[{host}]" if ":" in host else host


def _addresses() -> list[str]:
    """IPv4 addresses of the interfaces, in their order."""
    addresses = []
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as asked:
        for _, name in socket.if_nameindex():
            request = struct.pack("256s", name.encode()[:15])
            try:
                answer = fcntl.ioctl(asked.fileno(), _SIOCGIFADDR, request)
            except OSError:  # it has none
                continue
            addresses.append(socket.inet_ntoa(answer[20:24]))
    return addresses


# HTTP with a limit of time for the head of a request, which uvicorn itself waits for -------------

HEAD_S = 10.0
"""From the connection, or from the first byte after an answer, to the end of the head."""


class TimedProtocol(H11Protocol):
    """Closes connections that send half a head, however slowly they go on."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self._head_timer: asyncio.TimerHandle | None = None

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        super().connection_made(transport)
        self._time_head()

    def data_received(self, data: bytes) -> None:
        super().data_received(data)
        self._time_head()

    def on_response_complete(self) -> None:
        super().on_response_complete()
        if self.conn.trailing_data[0]:
            self._time_head()

    def connection_lost(self, exc: Exception | None) -> None:
        self._end_timer()
        super().connection_lost(exc)

    def _time_head(self) -> None:
        """Begin to count where a head is due, and end where it is there."""
        if self.conn.their_state is not h11.IDLE:
            self._end_timer()
        elif self._head_timer is None:
            self._head_timer = self.loop.call_later(HEAD_S, self._close)

    def _end_timer(self) -> None:
        if self._head_timer:
            self._head_timer.cancel()
        self._head_timer = None

    def _close(self) -> None:
        self._head_timer = None
        if self.conn.their_state is h11.IDLE and not self.transport.is_closing():
            self.transport.close()
