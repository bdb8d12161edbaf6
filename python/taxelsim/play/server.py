"""A server of viser that listens on the loopback interface and demands a random token.

The address is http://127.0.0.1:PORT/TOKEN/. The page opens its websocket below the same path, so that one check covers both.
"""

from __future__ import annotations

import contextlib
import hmac
import http
import io
import secrets
import threading
from collections.abc import Callable, Iterator
from typing import Any

import viser
import websockets.asyncio.server as websocket_server
from viser._messages import FileTransferPart, FileTransferStartUpload, ShareUrlDisconnect, ShareUrlRequest
from websockets.datastructures import Headers
from websockets.http11 import Request, Response

from ..errors import IoError

LOOPBACK = "127.0.0.1"
_NAMES = (LOOPBACK, "localhost")
_TOKEN_BYTES = 24
_starting = threading.Lock()


class Guard:
    """Refuses requests of other pages and other hosts, and requests without the token."""

    def __init__(self) -> None:
        self.token = secrets.token_urlsafe(_TOKEN_BYTES)
        self.is_installed = False

    def refusal(self, request: Request) -> str | None:
        """What is wrong with a request; None if it is accepted, and the token is then removed from its path."""
        hosts, origins = request.headers.get_all("Host"), request.headers.get_all("Origin")
        if len(hosts) != 1 or hosts[0].partition(":")[0] not in _NAMES:  # against DNS rebinding
            return "Host is not allowed: this machine's loopback address"
        is_websocket = request.headers.get("Upgrade", "").lower() == "websocket"
        if origins != [f"http://{hosts[0]}"] and (origins or is_websocket):
            return "Origin is not allowed: the page of this server"
        token, _, rest = request.path.partition("?")[0].removeprefix("/").partition("/")
        if not hmac.compare_digest(token.encode(), self.token.encode()):
            return "the address needs the token that the program printed"
        request.path = f"/{rest}"
        return None

    def around(self, serve_page: Callable[[Any, Request], Any]) -> Callable[[Any, Request], Any]:
        """The function `process_request` of a server whose own function is serve_page."""
        self.is_installed = True

        def process_request(connection: Any, request: Request) -> Any:
            refused = self.refusal(request)
            if refused is None:
                response = serve_page(connection, request)
                if isinstance(response, Response):
                    response.headers["Referrer-Policy"] = "no-referrer"
                    response.headers["Cache-Control"] = "no-store"
                return response
            body = f"{refused}\n".encode()
            headers = Headers({"Content-Type": "text/plain; charset=utf-8", "Content-Length": str(len(body)), "Connection": "close"})
            return Response(http.HTTPStatus.FORBIDDEN, "Forbidden", headers, body)

        return process_request


@contextlib.contextmanager
def _guarding(guard: Guard) -> Iterator[None]:
    """Puts the guard into the websocket server that starts meanwhile. A server that another thread starts meanwhile is guarded as well."""
    original = websocket_server.serve

    def serve(*arguments: Any, process_request: Any, **options: Any) -> Any:
        return original(*arguments, process_request=guard.around(process_request), **options)

    with _starting, contextlib.redirect_stdout(io.StringIO()):  # viser prints an address without the token
        websocket_server.serve = serve
        try:
            yield
        finally:
            websocket_server.serve = original


def _limit_uploads(gui: viser.GuiApi, max_bytes: int, say: Callable[[str], None]) -> None:
    """Each browser uploads one file at a time, of `max_bytes` at most, and no more bytes than it announced. say: gets a refusal."""
    connections, states = gui._websock_interface, gui._current_file_upload_states
    start, receive = gui._handle_file_transfer_start, gui._handle_file_transfer_part

    def limited_start(client: Any, message: FileTransferStartUpload) -> None:
        gui._drop_uploads_from_client(client)
        if 0 <= message.size_bytes <= max_bytes and 0 <= message.part_count <= max_bytes:
            start(client, message)
        else:
            say(f"a file of {message.size_bytes} bytes is not allowed: at most {max_bytes}")

    def limited_part(client: Any, message: FileTransferPart) -> None:
        state = states.get(message.transfer_uuid)
        if state is not None and state["transferred_bytes"] + len(message.content) > state["total_bytes"]:
            states.pop(message.transfer_uuid, None)
        else:
            receive(client, message)

    for message, old, new in ((FileTransferStartUpload, start, limited_start), (FileTransferPart, receive, limited_part)):
        connections.unregister_handler(message, old)
        connections.register_handler(message, new)


def start_server(port: int, label: str, max_upload_bytes: int, say: Callable[[str], None]) -> tuple[viser.ViserServer, Guard]:
    """Starts a server on `port`, 0 for a free one, or on the next free port. say: gets one line where an upload is refused.

    Raises IoError if it cannot be protected.
    """
    guard = Guard()
    with _guarding(guard):
        server = viser.ViserServer(host=LOOPBACK, port=port, label=label, verbose=False)
    if not guard.is_installed:
        server.stop()
        raise IoError(f"viser {viser.__version__} cannot be protected by a token: 1.1 is supported")
    for message in (ShareUrlRequest, ShareUrlDisconnect):
        server._websock_server.unregister_handler(message)
    _limit_uploads(server.gui, max_upload_bytes, say)
    server.gui.configure_theme(show_share_button=False, show_logo=False, control_width="large")
    return server, guard
