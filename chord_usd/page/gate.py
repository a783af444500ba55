"""Who may talk to the page: a browser of this machine, or whoever has the token.

A page from elsewhere can make a browser send requests to 127.0.0.1: under a name of its own that
leads there (seen by Host), or in its own name (seen by Origin). Both are refused.
"""

from __future__ import annotations

import hmac
import ipaddress
from http.cookies import CookieError, SimpleCookie
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

    def __init__(self, app: ASGIApp, *, host: str, token: str = "") -> None:
        """host: the interface that is listened on; token: that requests must have, if any."""
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
        host = headers.get("host", "")
        if not self._is_ours(host):
            return refused("this name does not lead here: open the address that was printed", 403)
        origin = headers.get("origin")
        if origin is not None and origin != f"{scope['scheme']}://{host}":
            return refused("the request comes from another page", 403)
        if headers.get("sec-fetch-site") == "cross-site" and scope["method"] != "GET":
            return refused("the request comes from another page", 403)
        return self._token_refusal(scope, headers) if self._token else None

    def _is_ours(self, host: str) -> bool:
        name = urlsplit(f"//{host}").hostname or ""
        shown = f"[{name}]" if ":" in name else name
        if shown in LOOPBACK_NAMES or shown == self._host:
            return True
        # On all interfaces the machine has addresses that we do not know, but no foreign name.
        return bool(self._token) and _is_address(name)

    def _token_refusal(self, scope: Scope, headers: Headers) -> Response | None:
        given = parse_qs(scope["query_string"].decode("latin-1")).get("token", [""])[0]
        if self._is_token(given) and scope["method"] == "GET":
            # Out of the address bar, the history and what people copy from there.
            answer = RedirectResponse(scope["path"], 303)
            answer.set_cookie(COOKIE, self._token, httponly=True, samesite="strict")
            return answer
        if not self._is_token(_cookie(headers)):
            return refused("the token is missing: open the address that was printed", 401)
        return None

    def _is_token(self, text: str) -> bool:
        return hmac.compare_digest(text.encode(), self._token.encode())


def refused(sentence: str, status: int) -> JSONResponse:
    """What cannot be done, as the page shows it."""
    return JSONResponse({"error": sentence}, status)


def _cookie(headers: Headers) -> str:
    try:
        morsel = SimpleCookie(headers.get("cookie", "")).get(COOKIE)
    except CookieError:
        return ""
    return morsel.value if morsel else ""


def _is_address(name: str) -> bool:
    try:
        ipaddress.ip_address(name)
    except ValueError:
        return False
    return True
