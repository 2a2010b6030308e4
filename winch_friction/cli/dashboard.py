"""`winch-friction dashboard`: the running nodes, or a bag, as a page on this machine."""

import contextlib
import json
import threading
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Annotated, Any

import typer

from winch_friction.cli.console import finite
from winch_friction.cli.optional import OptionalPath
from winch_friction.physics.errors import InputError

LOOPBACK = "127.0.0.1"  # nobody else's business: a crane's network is not the place for an open page
KEEP_ALIVE = 5.0  # s; a comment on the stream, so that a dead connection is noticed


def command(
    bag: Annotated[OptionalPath, typer.Option(help="Show a bag instead of running nodes.")] = None,
    namespace: Annotated[str, typer.Option(help="Namespace of the winch's nodes.")] = "",
    joint: Annotated[str, typer.Option(help="Joint of the speed; none: winch_motor, else the first.")] = "",
    rate: Annotated[float, typer.Option(min=0.0, help="Pace of a bag: 1 as it was, 0 at once.")] = 1.0,
    port: Annotated[int, typer.Option(min=0, max=65535, help="Port; 0: a free one.")] = 8765,
) -> None:
    """Serve a page on 127.0.0.1: torque over time and speed, estimates with bands, tracking error, health.

    It reconnects by itself and needs no network. End it with Ctrl-C.

    Examples:

      winch-friction dashboard

      winch-friction dashboard --bag out/demo/bag --rate 5 --port 9000
    """
    from winch_friction.cli.live import frames

    with serving(frames(bag, namespace, rate, joint), port) as address:
        print(f"open {address}", flush=True)
        threading.Event().wait()


class Broadcast:
    """The frames of one source for any number of readers; a reader that comes late begins with what was kept."""

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._sent: list[str] = []
        self.ended = ""
        self._closed = False

    def send(self, frame: dict[str, Any]) -> None:
        """A frame for everybody."""
        with self._changed:
            self._sent.append(json.dumps(finite(frame)))
            self._sent = self._sent[-3000:] if len(self._sent) > 6000 else self._sent  # ten minutes
            self._changed.notify_all()

    def end(self, said: str) -> None:
        """Nothing more will come."""
        with self._changed:
            self.ended = said or "ended"
            self._changed.notify_all()

    def close(self) -> None:
        """Drop every reader: the server goes, and whoever still looks tries again."""
        with self._changed:
            self._closed = True
            self._changed.notify_all()

    def lines(self) -> Iterator[str]:
        """Lines of an event stream."""
        position = max(0, len(self._sent) - 600)
        while True:
            with self._changed:
                if position >= len(self._sent) and not self.ended and not self._closed:
                    self._changed.wait(KEEP_ALIVE)
                if self._closed:
                    return
                new, position = self._sent[position:], len(self._sent)
                ended = self.ended
            yield "".join(f"data: {each}\n\n" for each in new) or ": still here\n\n"
            if ended:
                yield f"event: end\ndata: {ended}\n\n"
                return


@contextlib.contextmanager
def serving(frames: Iterator[dict[str, Any]], port: int) -> Iterator[str]:
    """The page and its stream on loopback; gives the address. A port that is taken raises `InputError`."""
    from winch_friction.report.dashboard import dashboard_page

    broadcast, page = Broadcast(), dashboard_page().encode()

    class Handler(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            if self.path.rstrip("/") == "":
                self._answer("text/html; charset=utf-8", page)
            elif self.path == "/events":
                self._stream()
            else:
                self.send_error(404)

        def _answer(self, kind: str, content: bytes) -> None:
            self.send_response(200)
            self.send_header("Content-Type", kind)
            self.send_header("Content-Length", str(len(content)))
            self.end_headers()
            self.wfile.write(content)

        def _stream(self) -> None:
            self.send_response(200)
            self.send_header("Content-Type", "text/event-stream")
            self.send_header("Cache-Control", "no-store")
            self.end_headers()
            with contextlib.suppress(BrokenPipeError, ConnectionResetError):
                for line in broadcast.lines():
                    self.wfile.write(line.encode())
                    self.wfile.flush()

        def log_message(self, *_: Any) -> None:
            """Quiet: a terminal is no place for every request."""

    try:
        server = ThreadingHTTPServer((LOOPBACK, port), Handler)
    except OSError as error:
        raise InputError(f"--port {port}: {error.strerror}; give another, or 0 for a free one") from error
    server.daemon_threads = True
    for job in (server.serve_forever, lambda: _pump(frames, broadcast)):
        threading.Thread(target=job, daemon=True).start()
    try:
        yield f"http://{LOOPBACK}:{server.server_address[1]}/"
    finally:
        broadcast.close()
        server.shutdown()
        server.server_close()


def _pump(frames: Iterator[dict[str, Any]], broadcast: Broadcast) -> None:
    from winch_friction.records.telemetry import estimates, faults, inputs, state

    said = ""
    try:
        for frame in frames:
            status, notes = frame.pop("status"), frame.pop("notes", ())
            broadcast.send({**frame, "state": [*state(status), *notes], "estimates": estimates(status),
                            "inputs": inputs(status), "faults": faults(status)})  # fmt: skip
    except InputError as error:
        said = str(error)
    finally:  # a page that waits for ever would look like a winch that stands still
        broadcast.end(said)
