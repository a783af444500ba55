"""serve: a page in the browser, over the houses of a folder."""

from __future__ import annotations

import argparse
import ipaddress

from chord_usd.base.runtime import console
from chord_usd.base.runtime.extras import needed_for
from chord_usd.base.runtime.locations import absolute
from chord_usd.faces.commands.common import Outcome, Verbs, add_verb, whole_number
from chord_usd.faces.commands.paths import output_place

PORT = 8321


def add(verbs: Verbs) -> None:
    """Adds the verb."""
    parser = add_verb(verbs, "serve", run, "serve a page that furnishes plans, in the browser")
    parser.add_argument(
        "--root", type=output_place, required=True, metavar="DIR",
        help="the folder that holds the page's houses, made where there is none",
    )  # fmt: skip
    parser.add_argument(
        "--host", type=_address, default="127.0.0.1", metavar="ADDRESS",
        help="the interface to listen on (127.0.0.1)",
    )  # fmt: skip
    parser.add_argument(
        "--port", type=whole_number(0, 65_535), default=PORT, metavar="N",
        help=f"the port to listen on; 0 takes one that is free ({PORT})",
    )  # fmt: skip


def _address(text: str) -> str:
    try:
        return str(ipaddress.ip_address(text))
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text[:40]!r} is no address of an interface") from None


def run(options: argparse.Namespace) -> Outcome:
    """Runs the verb, until it is interrupted or terminated."""
    with needed_for("chord-usd serve"):
        from chord_usd.faces.page.serving import serve_page

    def say(address: str) -> None:
        print(address, file=console.stdout(), flush=True)

    serve_page(absolute(options.root), options.host, options.port, say)
    return Outcome(None)
