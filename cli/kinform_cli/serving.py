"""A page served to browsers on this machine, and told to load itself again when there is a newer one.

The server listens on the loopback address alone, and answers only requests that name it as such: a page of elsewhere
that has its own name resolved to this machine gets nothing. It reads no file and takes no input.
"""

from __future__ import annotations

import json
import threading
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

from kinform_cli.errors import refuse

KEEP_ALIVE = 15.0
"""s after which a browser that follows a page is told again what it knows: so connections that are gone are noticed."""


HOST = "127.0.0.1"


class PageServer:
    """Serves the newest page that it was given; a context, at whose end nothing listens any more."""

    def __init__(self, port: int):
        """InputError where the port cannot be had; 0 takes a free one."""
        self._changed = threading.Condition()
        self._pages = 0
        self._html = _waiting()
        self._text = ""
        self._over = False
        try:
            self._server = ThreadingHTTPServer((HOST, port), _handler(self))
        except OSError as error:
            remedy = "name another port with --port, or leave it out"
            raise refuse(f"port {port} cannot be had: {error.strerror}", remedy=remedy) from None
        self._server.daemon_threads = True

    @property
    def address(self) -> str:
        """What a browser is to open."""
        return f"http://{HOST}:{self._server.server_port}/"

    @property
    def names(self) -> tuple[str, str]:
        """By which requests may call it."""
        return f"{HOST}:{self._server.server_port}", f"localhost:{self._server.server_port}"

    @property
    def next_version(self) -> str:
        """Of the page that is to be made now."""
        return str(self._pages + 1)

    def show(self, html: str) -> None:
        """This page, made as the `next_version`, from now on."""
        with self._changed:
            self._pages, self._html, self._text = self._pages + 1, html, ""
            self._changed.notify_all()

    def say(self, text: str) -> None:
        """A line on the page that is shown, as it is: why there is no newer one."""
        with self._changed:
            self._text = text
            self._changed.notify_all()

    def __enter__(self) -> PageServer:
        threading.Thread(target=self._server.serve_forever, daemon=True).start()
        return self

    def __exit__(self, *_: object) -> None:
        with self._changed:
            self._over = True
            self._changed.notify_all()
        self._server.shutdown()
        self._server.server_close()

    def page(self) -> bytes:
        """The page as it is now."""
        with self._changed:
            return self._html.encode()

    def news(self, known: tuple[str, str] | None) -> tuple[str, str] | None:
        """(version, text) as soon as they are not those that are known, or after a while; None at the end."""
        with self._changed:
            self._changed.wait_for(lambda: self._over or (str(self._pages), self._text) != known, KEEP_ALIVE)
            return None if self._over else (str(self._pages), self._text)


def _handler(pages: PageServer) -> type[BaseHTTPRequestHandler]:
    class Handler(BaseHTTPRequestHandler):
        """Answers for `/` and `/changes`."""

        def do_GET(self) -> None:
            """The page, or what changes of it, as server-sent events."""
            if self.headers.get("Host") not in pages.names:
                self.send_error(HTTPStatus.FORBIDDEN, "this page is for this machine only")
            elif self.path == "/":
                body = pages.page()
                self._head("text/html; charset=utf-8")
                self.send_header("Content-Length", str(len(body)))
                self.end_headers()
                self.wfile.write(body)
            elif self.path == "/changes":
                self._head("text/event-stream")
                self.end_headers()
                self._follow()
            else:
                self.send_error(HTTPStatus.NOT_FOUND)

        def _follow(self) -> None:
            known = None
            try:
                while (now := pages.news(known)) is not None:
                    version, text = known = now
                    self.wfile.write(f"data: {json.dumps({'version': version, 'text': text})}\n\n".encode())
                    self.wfile.flush()
            except OSError:  # the browser has gone
                return

        def _head(self, kind: str) -> None:
            self.send_response(HTTPStatus.OK)
            self.send_header("Content-Type", kind)
            self.send_header("Cache-Control", "no-store")
            self.send_header("X-Content-Type-Options", "nosniff")

        def log_message(self, format: str, *args: Any) -> None:
            """Requests are not told on the terminal."""

    return Handler


def _waiting() -> str:
    """What is shown before the first page."""
    return (
        "<!doctype html><html lang=en><meta charset=utf-8><meta http-equiv=refresh content=1>"
        "<title>kinform</title><p>The first run is under way, or the input is bad: the terminal says which."
    )
