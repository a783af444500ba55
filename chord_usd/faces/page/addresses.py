"""Addresses of this machine, as a browser elsewhere asks for them."""

from __future__ import annotations

import fcntl
import ipaddress
import socket
import struct

_SIOCGIFADDR = 0x8915
"""The request of Linux for the IPv4 address of an interface."""


def shown_address(host: str) -> str:
    """The host part of the address of a server, as other machines can use it.

    host: the interface that it listens on. For all interfaces (0.0.0.0, ::) it is the IPv4 address
    of the first that is not loopback, else that of loopback. Nothing is sent or looked up.
    """
    if ipaddress.ip_address(host).is_unspecified:
        reachable = [one for one in _addresses() if not ipaddress.ip_address(one).is_loopback]
        host = (reachable or ["127.0.0.1"])[0]
    return f"[{host}]" if ":" in host else host


def _addresses() -> list[str]:
    """IPv4 addresses of the interfaces, in their order."""
    found = []
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as asked:
        for _, name in socket.if_nameindex():
            request = struct.pack("256s", name.encode()[:15])
            try:
                answer = fcntl.ioctl(asked.fileno(), _SIOCGIFADDR, request)
            except OSError:  # it has none
                continue
            found.append(socket.inet_ntoa(answer[20:24]))
    return found
