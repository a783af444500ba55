"""Who may talk to the page: whoever has the token, on this machine, too, which others may use.

A page from elsewhere can make a browser send requests to 127.0.0.1: under a name of its own that
leads there (seen by Host), or in its own name (seen by Origin). Both are refused.
"""

from __future__ import annotations

import hmac
import ipaddress
from collections.abc import Mapping
from urllib.parse import parse_qs, urlsplit

from starlette.datastructures import Headers, MutableHeaders
from starlette.responses import JSONResponse, RedirectResponse, Response
from starlette.types import ASGIApp, Message, Receive, Scope, Send

COOKIE = "chord-usd-token"
LOOPBACK_NAMES = ("127.0.0.1", "localhost", "[::1]")

_POLICY = "; ".join(
    (
        "default-src 'self'",
        "img-src 'self' blob: data:",  # textures of a GLB are blobs
        "connect-src 'self' blob:",
        "object-src 'none'",
        "base-uri 'none'",
        "form-action 'none'",
        "frame-ancestors 'none'",
    )
)

HEADERS = {
    "content-security-policy": _POLICY,
    "cross-origin-opener-policy": "same-origin",
    "cross-origin-resource-policy": "same-origin",
    "referrer-policy": "no-referrer",
    "x-content-type-options": "nosniff",
}


class Gate:
    """Refuses requests from elsewhere, before anything reads them."""

    def __init__(self, app: ASGIApp, *, host: str, token: str) -> None:
        """host: the interface that is listened on; token: that requests must have."""
        if not token:
            raise ValueError("a page without a token is anybody's")
        self._app, self._host, self._token = app, host, token

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http":
            if scope["type"] == "lifespan":
                await self._app(scope, receive, send)
            return  # no websockets here

        async def guarded(message: Message) -> None:
            if message["type"] == "http.response.start":
                headers = MutableHeaders(scope=message)
                for name, value in HEADERS.items():
                    headers[name] = value
            await send(message)

        answer = self._refusal(scope)
        await (answer or self._app)(scope, receive, guarded)

    def _refusal(self, scope: Scope) -> Response | None:
        headers = Headers(scope=scope)
        if len(headers.getlist("host")) > 1:
            return refused("the request names two hosts", 400)
        host = headers.get("host", "")
        if not self._is_ours(host):
            return refused("this name does not lead here: open the address that was printed", 403)
        origin = headers.get("origin")
        if origin is not None and origin != f"{scope['scheme']}://{host}":
            return refused("the request comes from another page", 403)
        if headers.get("sec-fetch-site") == "cross-site" and scope["method"] != "GET":
            return refused("the request comes from another page", 403)
        return self._token_refusal(scope, headers, f"{COOKIE}{_port(host)}")

    def _is_ours(self, host: str) -> bool:
        name = _name(host)
        shown = f"[{name}]" if ":" in name else name
        if shown in LOOPBACK_NAMES or shown == self._host:
            return True
        # On all interfaces the machine has addresses that we do not know, but no foreign name.
        return self._host not in LOOPBACK_NAMES and _is_address(name)

    def _token_refusal(self, scope: Scope, headers: Headers, cookie: str) -> Response | None:
        given = parse_qs(scope["query_string"].decode("latin-1")).get("token", [""])[0]
        if self._is_token(given) and scope["method"] == "GET":
            # Out of the address bar, the history and what people copy from there.
            answer = RedirectResponse(f"/{scope['path'].lstrip('/')}", 303)
            answer.set_cookie(cookie, self._token, httponly=True, samesite="strict")
            return answer
        if not self._is_token(_cookie(headers, cookie)):
            return refused("the token is missing: open the address that was printed", 401)
        return None

    def _is_token(self, text: str) -> bool:
        return hmac.compare_digest(text.encode(), self._token.encode())


def refused(sentence: str, status: int, headers: Mapping[str, str] | None = None) -> JSONResponse:
    """What cannot be done, as the page shows it."""
    return JSONResponse({"error": sentence}, status, headers)


def _name(host: str) -> str:
    try:
        return urlsplit(f"//{host}").hostname or ""
    except ValueError:  # brackets without an end
        return ""


def _port(host: str) -> str:
    """The port that a Host header names. Cookies are the same for all ports of a machine."""
    port = host.rpartition(":")[2]
    return f"-{port}" if port.isdecimal() else ""


def _cookie(headers: Headers, name: str) -> str:
    # Not by SimpleCookie, which gives up at whatever another program of this machine may have set.
    pairs = (pair.strip().partition("=") for pair in headers.get("cookie", "").split(";"))
    return next((value for key, _, value in pairs if key == name), "")


def _is_address(name: str) -> bool:
    try:
        ipaddress.ip_address(name)
    except ValueError:
        return False
    return True
