"""The local server of a page: it listens only on the loopback address, and serves only its own files and views.

The first part of each path is a random token, so that no other user or page can send requests.
"""

from __future__ import annotations

import errno
import json
import select
import socket
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from secrets import compare_digest, token_urlsafe
from typing import Any
from urllib.parse import parse_qsl, urlsplit

from prag_asp.errors import LimitReached, PragError, QueryError
from prag_asp.explore.turns import Turns
from prag_asp.html.player import PLAYER
from prag_asp.stop_reason import StopKind

HOST = "127.0.0.1"

PATIENCE = 30.0
"""The number of seconds after which a connection without a request is closed."""

MOST_FIELDS = 16
"""The maximum number of fields in a request."""

LARGEST_NUMBER = 10**15
"""The largest number that a window may assign to a request."""

KINDS = {
    ".html": "text/html; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".svg": "image/svg+xml",
}
"""The media types of the files that make up a page."""

HEADERS = {
    "Content-Security-Policy": "default-src 'none'; script-src 'self'; style-src 'self'; "
    "img-src 'self' blob:; media-src 'self' blob:; connect-src 'self'; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cache-Control": "no-store",
}

Fields = Mapping[str, str]
View = Callable[[Fields], Any]
"""A function from the fields of a request to the dataclass of a view."""


@dataclass(frozen=True)
class Picture:
    """A picture or a video that a view returns, with its media type."""

    kind: str
    content: bytes


@dataclass(frozen=True)
class Elsewhere:
    """A view whose work runs in another process: `work` returns the view while other requests are answered."""

    work: Callable[[], Any]


class PageServer(ThreadingHTTPServer):
    """A server of the files in a folder, the player of 3D scenes, and views as JSON.

    `turns` lets only one request compute at a time. `report` receives one line for each internal error.

    Raises:
        QueryError: the port is in use, or may not be used.
    """

    daemon_threads = True
    block_on_close = False
    request_queue_size = 64

    def __init__(
        self,
        folder: Path,
        views: Mapping[str, View],
        turns: Turns,
        *,
        port: int = 0,
        report: Callable[[str], None] = lambda line: None,
    ) -> None:
        self.views, self.turns, self.report = views, turns, report
        self.token = token_urlsafe(24)
        paths = (path for each in (PLAYER, folder) for path in each.iterdir())
        self.files = {path.name: path.read_bytes() for path in paths if path.suffix in KINDS}
        try:
            super().__init__((HOST, port), _Handler)
        except OSError as error:
            if error.errno == errno.EADDRINUSE:
                raise QueryError(
                    f"--port {port}: another program uses it; choose another port, or leave it out"
                ) from None
            raise QueryError(f"--port {port}: {error.strerror}; choose another port, or leave it out") from None

    @property
    def port(self) -> int:
        """The port on which the server listens."""
        return int(self.server_address[1])

    @property
    def link(self) -> str:
        """The address of the page, to which a query may be appended."""
        return f"http://{HOST}:{self.port}/{self.token}/"

    def server_close(self) -> None:
        """End the work on all requests, and close the socket."""
        self.turns.close()
        super().server_close()

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Ignore a connection that its client has closed; the handler itself reports internal errors."""


class _Handler(BaseHTTPRequestHandler):
    """The handler of one request."""

    server: PageServer
    timeout = PATIENCE
    protocol_version = "HTTP/1.1"
    server_version = "prag-asp"
    sys_version = ""

    def do_GET(self) -> None:
        """Answer with a file or a view."""
        refusal = self._refusal()
        if refusal is not None:
            self._send_problem(*refusal)
            return
        name = urlsplit(self.path).path.removeprefix(f"/{self.server.token}/")
        if name.startswith("api/") and name.removeprefix("api/") in self.server.views:
            self._answer(self.server.views[name.removeprefix("api/")])
        elif name == "api/doing":  # answered while another request computes
            self._send_json(HTTPStatus.OK, asdict(self.server.turns.doing))
        elif (name or "index.html") in self.server.files:
            file = name or "index.html"
            self._send(HTTPStatus.OK, KINDS[Path(file).suffix], self.server.files[file])
        else:
            self._send_problem(HTTPStatus.NOT_FOUND, "there is no such page")

    def _refusal(self) -> tuple[HTTPStatus, str] | None:
        """Return why a request is refused, or None if it comes from the page itself."""
        hosts = {f"{name}:{self.server.port}" for name in (HOST, "localhost")}
        origin, site = self.headers.get("Origin"), self.headers.get("Sec-Fetch-Site", "none")
        if self.headers.get("Host") not in hosts:
            return HTTPStatus.FORBIDDEN, "the request names another host"
        if origin is not None and origin not in {f"http://{host}" for host in hosts}:
            return HTTPStatus.FORBIDDEN, "the request comes from another page"
        token, path = self.server.token, urlsplit(self.path).path
        if not compare_digest(path.split("/")[1].encode() if path.startswith("/") else b"", token.encode()):
            return HTTPStatus.FORBIDDEN, "the link is not from this run; open the link that prag-asp explore printed"
        if path.startswith(f"/{token}/api/") and site not in ("same-origin", "none"):
            return HTTPStatus.FORBIDDEN, "the request comes from another page"
        return None

    def _answer(self, view: View) -> None:
        try:
            fields = dict(parse_qsl(urlsplit(self.path).query, keep_blank_values=True, max_num_fields=MOST_FIELDS))
        except ValueError:
            self._send_problem(HTTPStatus.BAD_REQUEST, "the request has too many fields")
            return
        try:
            request = fields.get("window", "")[:64], _number(fields.get("number", "0"))
            with self.server.turns.turn(*request, gone=self._gone):
                found = view(fields)
            if isinstance(found, Elsewhere):
                with self.server.turns.turn(*request, elsewhere=True, gone=self._gone):
                    found = found.work()
        except LimitReached as error:
            if error.reason.kind is StopKind.CANCEL:
                self._send_problem(HTTPStatus.CONFLICT, str(error))
            else:
                self._send_refusal(*error.lines)
        except PragError as error:
            self._send_refusal(*error.lines)
        except RecursionError:
            self._send_refusal("the condition is nested too deeply; make it flatter")
        except Exception as error:  # an internal error ends one request, not the server
            self.server.report(f"{urlsplit(self.path).path.rpartition('/')[2]}: {type(error).__name__}: {error}")
            self._send_problem(HTTPStatus.INTERNAL_SERVER_ERROR, "an internal error occurred; see the terminal")
        else:
            if isinstance(found, Picture):
                self._send(HTTPStatus.OK, found.kind, found.content)
            else:
                self._send_json(HTTPStatus.OK, asdict(found))

    def _gone(self) -> bool:
        """Return whether the client has closed the connection."""
        try:
            readable = select.poll()
            readable.register(self.connection, select.POLLIN)
            return bool(readable.poll(0)) and not self.connection.recv(1, socket.MSG_PEEK)
        except OSError:  # the client has reset the connection
            return True

    def _send_problem(self, status: HTTPStatus, *lines: str) -> None:
        self._send_json(status, {"lines": lines})

    def _send_refusal(self, *lines: str) -> None:
        """Answer a mistake of the user with status 200, because browsers report any other as an error of the page."""
        self._send_json(HTTPStatus.OK, {"refused": lines})

    def _send_json(self, status: HTTPStatus, value: Any) -> None:
        self._send(status, "application/json", json.dumps(value).encode())

    def _send(self, status: HTTPStatus, kind: str, content: bytes) -> None:
        self.send_response(status)
        for name, value in HEADERS.items():
            self.send_header(name, value)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(content)))
        self.end_headers()
        self.wfile.write(content)

    def log_message(self, format: str, *args: Any) -> None:
        """Print nothing, because results go to the page."""


def _number(text: str) -> int:
    """Return the number of a request.

    Raises:
        QueryError: the text is not a number.
    """
    if not (text.isascii() and text.isdigit() and len(text) < len(str(LARGEST_NUMBER))):
        raise QueryError(f"the number of a request is {text[:20]!r}; it needs digits")
    return int(text)
