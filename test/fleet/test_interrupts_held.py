"""Ctrl-C goes to every process of a terminal: the workers of a fleet never hear it, the process that ends them does."""

import subprocess
import sys
from types import SimpleNamespace

from winch_friction.fleet import schedule

BEGIN = """
import os, signal, subprocess, sys
from multiprocessing import resource_tracker
from winch_friction.fleet.schedule import _interrupts_held
signal.signal(signal.SIGINT, signal.default_int_handler)  # ignored in what a shell starts in the background
ASK = "import signal; print(signal.SIGINT in signal.pthread_sigmask(signal.SIG_BLOCK, ()), flush=True)"
try:
    with _interrupts_held():
        resource_tracker.ensure_running()  # as the first process that multiprocessing begins does
        subprocess.run([sys.executable, "-S", "-c", ASK])
        os.kill(os.getpid(), signal.SIGINT)
        print("held", flush=True)
except KeyboardInterrupt:
    print("heard", signal.SIGINT in signal.pthread_sigmask(signal.SIG_BLOCK, ()))
"""


def test_workers_do_not_hear_an_interrupt_and_it_is_not_lost():
    """Each worker of an interrupted fleet left a traceback of its own in the terminal."""
    said = subprocess.run([sys.executable, "-c", BEGIN], capture_output=True, text=True, check=False)
    assert said.stdout.split() == ["True", "held", "heard", "False"], said.stderr


def test_on_an_interrupt_the_own_workers_are_killed_and_after_the_work_they_end_by_themselves(monkeypatch):
    """A piece of work in its middle was waited for, up to 4.7 s after Ctrl-C."""
    killed = []
    children = [SimpleNamespace(kill=lambda name=name: killed.append(name)) for name in "abc"]
    monkeypatch.setattr(schedule, "active_children", lambda: children)
    end = schedule._ended_at_once(children[:1])
    assert not end(None, None, None)
    assert killed == []
    assert not end(KeyboardInterrupt, None, None)  # which goes on
    assert killed == ["b", "c"]
