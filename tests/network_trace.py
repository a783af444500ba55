"""What a command does on the network, by strace: C code and child processes included."""

from __future__ import annotations

import ipaddress
import re
import shutil
import subprocess
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

TRACED = "execve,connect,bind,listen,sendto,sendmsg,sendmmsg"

_ADDRESS = re.compile(
    r'inet_addr\("(?P<four>[^"]+)"\)|inet_pton\(AF_INET6, "(?P<six>[^"]+)"'
    r"|<(?:TCP|UDP)v6:\[\[(?P<own_six>[^\]]+)\]:\d|<(?:TCP|UDP):\[(?P<own>[\d.]+):\d"
)
_UNBOUND = re.compile(r"listen\(\d+<(?:TCP|UDP)(?:v6)?:\[\d+\]>")
"""A socket without an address listens on all of them."""
_NAME_SERVICE = re.compile(r"htons\(53\)|/(?:nscd|systemd/resolve)/\S+\}, \d+\) += 0|:53\]?\]>")
"""Port 53 of any machine, also of this one; a local service that answers for it."""


def run_traced(
    command: Sequence[object], log: Path, env: Mapping[str, str], seconds: float = 300
) -> tuple[subprocess.CompletedProcess[str], list[str]]:
    """What a command did, and the system calls by which it looked up a name or left the machine.

    log: where strace writes. Fails where strace is not there or saw nothing.
    """
    strace = shutil.which("strace")
    assert strace, "strace is missing. Try: apt-get install strace"
    options = ["-f", "--seccomp-bpf", "-qq", "-yy", "-s", "64", "-e", f"trace={TRACED}"]
    done = subprocess.run(
        [strace, *options, "-e", "signal=none", "-o", str(log), *map(str, command)],
        env=dict(env),
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=seconds,
        check=False,
    )
    lines = log.read_text(errors="replace").splitlines()
    assert any("execve(" in line for line in lines), done.stderr
    return done, [line for line in lines if _leaves(line)]


def _leaves(line: str) -> bool:
    if "execve(" in line:
        return False
    if _UNBOUND.search(line) or _NAME_SERVICE.search(line):
        return True
    return any(not _is_loopback(a) for a in _addresses(line))


def _addresses(line: str) -> Iterator[str]:
    for found in _ADDRESS.finditer(line):
        yield next(address for address in found.groups() if address)


def _is_loopback(address: str) -> bool:
    parsed = ipaddress.ip_address(address)
    mapped = getattr(parsed, "ipv4_mapped", None)
    return (mapped or parsed).is_loopback
