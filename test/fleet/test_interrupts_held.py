"""Ctrl-C goes to every process of a terminal: the workers of a fleet never hear it, the process that ends them does."""

import subprocess
import sys

BEGIN = """
import os, signal, subprocess, sys
from multiprocessing import resource_tracker
from winch_friction.fleet.schedule import _interrupts_held
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
