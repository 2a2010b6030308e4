"""The dashboard in a real browser: draws frames, is accessible, reconnects, says when the source has ended."""

import itertools
import math
import threading
import time
import urllib.request

import pytest
from pages import COVERED, DESK, INK, PHONE, SCHEMES, TABLET, keep_screenshot, violations

from winch_friction.cli.dashboard import serving

pytestmark = pytest.mark.browser


def frames(stop):
    """What running nodes would send, ten times a second; one age is infinite, as of an input that was never heard."""
    for k in itertools.count():
        if stop.wait(0.1):
            return
        now = [[0.1 * k, 300.0 * math.sin(0.1 * k)]]
        values = {
            "K2": "3.8e10",
            "K2 std": "1e9",
            "K2 status": "seed",
            "K5": "1.16e-14",
            "K5 std": "1e-15",
            "K5 status": "seed",
            "C1": "2",
            "C1 std": "0.5",
            "C1 status": "learned",
        }
        status = {
            "estimator: parameters": {"level": 0, "message": "", "values": values},
            "compensator: feedforward": {"level": 1, "message": "an input was lost", "values": {}},
            "compensator: inputs": {"level": 0, "message": "", "values": {"speed rate": "0", "speed age": "inf"}},
        }
        yield {"time": 0.1 * k, "points": {"speed": now, "feedforward": now}, "status": status}


@pytest.fixture
def stop():
    event = threading.Event()
    yield event
    event.set()


@pytest.mark.parametrize("width", [DESK, TABLET, PHONE])
def test_the_page_is_accessible_at_every_size(visit, stop, width):
    with serving(frames(stop), 0) as address:
        page, said = visit(address, width, SCHEMES[0])
        page.wait_for_function("document.querySelector('#torque .main-svg')")
        for scheme in SCHEMES:
            page.emulate_media(color_scheme=scheme)
            page.wait_for_function(f"document.querySelector('#torque').layout.font.color === {INK[scheme]!r}")
            assert violations(page) == []
            keep_screenshot(page, "dashboard", width, scheme)
        assert not page.evaluate("document.documentElement.scrollWidth > innerWidth")
        assert page.evaluate(COVERED) == 0
        assert said == []


def test_the_page_draws_what_comes_and_reconnects(visit, stop):
    with serving(frames(stop), 0) as address:
        port = int(address.rsplit(":", 1)[1].strip("/"))
        page, said = visit(address, 768, "dark")
        page.wait_for_function("+document.documentElement.dataset.frames > 10")
        page.wait_for_function("document.querySelector('#torque .main-svg')")
        assert "an input was lost" in page.inner_text("#faults")
        assert "learned" in page.inner_text("#estimates")
        assert "3.8e+10" in page.inner_text("#estimates")  # not a row of zeros
        assert "1.16e−14" in page.inner_text("#estimates")  # with a minus: behind a hyphen a phone breaks the number
        assert violations(page) == []
        assert said == []
    page.wait_for_function("document.documentElement.dataset.link === 'lost'", timeout=15000)
    again = threading.Event()
    with serving(frames(again), port):
        page.wait_for_function("document.documentElement.dataset.link === 'open'", timeout=15000)
        again.set()
        page.wait_for_function("document.documentElement.dataset.link === 'ended'", timeout=15000)


def test_only_this_machine_is_served_and_nothing_else_is_there(stop):
    with serving(frames(stop), 0) as address:
        assert address.startswith("http://127.0.0.1:")
        with pytest.raises(urllib.error.HTTPError, match="404"):
            urllib.request.urlopen(address + "etc/passwd", timeout=5)
        with urllib.request.urlopen(address + "events", timeout=5) as stream:
            begin = time.monotonic()
            while not stream.readline().startswith(b"data: {"):
                assert time.monotonic() - begin < 5.0
