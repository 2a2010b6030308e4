"""Watch hears running publishers, in a process of its own."""

import itertools
import threading

from winch_friction.cli.live import live_frames


def test_the_listener_hears_what_is_published(bench, monkeypatch):
    monkeypatch.setenv("ROS_DOMAIN_ID", str(bench.domain))
    frames: list = []
    source = live_frames("")
    listener = threading.Thread(target=lambda: frames.extend(itertools.islice(source, 25)), daemon=True)
    listener.start()
    bench.announce()
    bench.drive(2.0)
    assert bench.spin(30.0, lambda: not listener.is_alive())
    source.close()
    speeds = [value for frame in frames for _, value in frame["points"].get("speed", [])]
    assert speeds
    assert max(map(abs, speeds)) < 1000.0  # rpm; the swell turns at 100 rad/s at most
