"""`winch-friction foxglove`: the running nodes, or a bag, for the Foxglove app; or as an MCAP file that it opens."""

import contextlib
import tempfile
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any

import typer

from winch_friction.cli.inputs import show_warnings
from winch_friction.cli.optional import OptionalPath
from winch_friction.physics.errors import InputError

LOOPBACK = "127.0.0.1"  # nobody else's business, as in `dashboard`


def command(
    bag: Annotated[OptionalPath, typer.Option(help="Serve a bag instead of running nodes.")] = None,
    namespace: Annotated[str, typer.Option(help="Namespace of the winch's nodes.")] = "",
    rate: Annotated[float, typer.Option(min=0.0, help="Pace of a bag: 1 as it was, 0 at once.")] = 1.0,
    port: Annotated[int, typer.Option(min=0, max=65535, help="Port; 0: a free one.")] = 8765,
    host: Annotated[str, typer.Option(help="Address to listen at; 0.0.0.0 lets the whole network look.")] = LOOPBACK,
    out: Annotated[OptionalPath, typer.Option(help="With --bag: write this .mcap file instead of serving.")] = None,
) -> None:
    """Serve the Foxglove WebSocket protocol on 127.0.0.1: ROS topics with their schemas, torque, estimates, health.

    In Foxglove: Open connection, Foxglove WebSocket, the address that is printed; layouts are in config/layouts.
    A bag begins when the first client subscribes, and again for the next. End it with Ctrl-C.

    Examples:

      winch-friction foxglove

      winch-friction foxglove --bag out/demo/bag --rate 5

      winch-friction foxglove --bag out/demo/bag --out demo.mcap
    """
    if out is not None:
        if bag is None:
            raise InputError("--out writes what a bag holds: give --bag; 'ros2 bag record' records running nodes")
        print(f"{out}: {written(bag, out, namespace)} messages of the bag, and what they say, with schemas")
        return
    with serving(bag, namespace, rate, port, host) as address:
        print(f"open {address} in Foxglove", flush=True)
        threading.Event().wait()


def written(bag: Path, out: Path, namespace: str = "") -> int:
    """Write a bag, with the channels that the server adds, as an MCAP file; returns the number of ROS messages.

    It is for Foxglove and readers of MCAP; those of ROS 2 want ROS messages alone (`convert run` writes such a file).
    Raises `InputError` where the file exists already or is not called .mcap.
    """
    from winch_friction.cli.live import bag_messages
    from winch_friction.records.atomic import put, taken
    from winch_friction.records.foxglove_channels import Relay, foxglove_sdk

    sdk = foxglove_sdk()
    if out.suffix != ".mcap" or taken(out):
        said = "exists already; remove it or choose another name" if taken(out) else "must end in .mcap"
        raise InputError(f"{out}: {said}")
    out.parent.mkdir(parents=True, exist_ok=True)
    context, count = sdk.Context(), 0
    with tempfile.TemporaryDirectory(dir=out.parent, prefix=f".{out.name}.") as folder:
        made = Path(folder) / out.name
        relay = Relay(context, namespace)
        with sdk.open_mcap(made, context=context):
            for message in bag_messages(bag, 0.0):
                relay.take(message)
                count += message.topic not in relay.passed
        put(made, out)
    show_warnings(relay.passed.values())
    return count


@contextlib.contextmanager
def serving(bag: Path | None, namespace: str, rate: float, port: int, host: str = LOOPBACK) -> Iterator[str]:
    """The server while the context lasts; gives its address. A port that is taken raises `InputError`."""
    from winch_friction.cli.live import Listener, bag_topics
    from winch_friction.records.foxglove_channels import Relay, foxglove_sdk

    sdk = foxglove_sdk()
    context = sdk.Context()
    relay, asked = Relay(context, namespace), Asked()
    if bag is not None:
        relay.advertise(bag_topics(bag))
        show_warnings(relay.passed.values())
    name = f"winch_friction {bag.name if bag is not None else namespace}".strip()
    try:
        server = sdk.start_server(name=name, host=host, port=port, server_listener=asked, context=context)
    except Exception as error:  # the SDK raises RuntimeError for whatever the system says
        raise InputError(f"--host {host} --port {port}: {error}; give another port, or 0 for a free one") from error
    ended = threading.Event()
    listener = Listener(namespace, "--raw") if bag is None else None
    job = threading.Thread(target=_pump, args=(server, relay, listener, bag, rate, asked.event, ended), daemon=True)
    job.start()
    try:
        yield f"ws://{host}:{server.port}"
    finally:
        ended.set()
        if listener is not None:
            listener.close()
        server.stop()


class Asked:
    """Notes that somebody subscribed: only then is there a point in playing a bag."""

    def __init__(self) -> None:
        self.event = threading.Event()

    def on_subscribe(self, client: Any, channel: Any) -> None:
        """A client wants a channel."""
        self.event.set()

    def __getattr__(self, name: str) -> Any:
        if name.startswith("on_"):
            return lambda *_: None
        raise AttributeError(name)


def _pump(server: Any, relay: Any, listener: Any, bag: Path | None, rate: float, asked: Any, ended: Any) -> None:
    from winch_friction.cli.live import bag_messages

    try:
        while not ended.is_set():
            if bag is not None:
                while not asked.wait(0.2):
                    if ended.is_set():
                        return
            messages = bag_messages(bag, rate) if bag is not None else listener.messages()
            for message in messages:
                if ended.is_set():
                    return
                relay.take(message)
            asked.clear()
    except InputError as error:
        print(error, flush=True)
        _tell(server, str(error))


def _tell(server: Any, said: str) -> None:
    from foxglove.websocket import StatusLevel

    server.publish_status(said, StatusLevel.Error)
