"""Ctrl-C from the first moment on: one line and status 130, whatever is being loaded, and no word once all is done."""

import signal
import subprocess
import sys
from functools import partial

import pytest

# an interrupt in the middle of a library's import, or when the interpreter ends
WHILE_LOADING = """
import os, signal, sys
class Pressed:
    def find_spec(self, name, path=None, target=None):
        if name == {name!r}:
            sys.meta_path.remove(self)
            os.kill(os.getpid(), signal.SIGINT)
sys.meta_path.insert(0, Pressed())
"""
WHEN_DONE = "import atexit, os, signal; atexit.register(lambda: os.kill(os.getpid(), signal.SIGINT))\n"
CALL = "import sys; from winch_friction.cli.entry import main; sys.argv[1:] = {words!r}; main()"


def _run(code, words):
    """As in a terminal: these tests may have been begun by a script that lets whatever it starts ignore Ctrl-C."""
    call = [sys.executable, "-c", code + CALL.format(words=words)]
    heard = partial(signal.signal, signal.SIGINT, signal.SIG_DFL)
    done = subprocess.run(call, capture_output=True, text=True, timeout=60, preexec_fn=heard)
    return done.returncode, done.stdout, done.stderr


@pytest.mark.parametrize("name", [
    "winch_friction.cli.main", "sympy",
    *(pytest.param(each, marks=pytest.mark.long) for each in ("typer", "rich.console", "winch_friction.cli.list")),
])  # fmt: skip
def test_an_interrupt_while_libraries_are_loaded_has_one_line(name):
    status, _, said = _run(WHILE_LOADING.format(name=name), ["list", "terms"])
    assert (status, said.lstrip("\n")) == (130, "winch-friction: interrupted\n")  # older Typer begins a line of its own


def test_a_library_that_takes_the_interrupt_for_another_error_does_not_hold_it_up():
    """An extension that is being loaded makes an ImportError of it, or nothing at all."""
    pressed = "os.kill(os.getpid(), signal.SIGINT)"
    taken = f"try:\n                {pressed}\n            except KeyboardInterrupt:\n                pass"
    status, shown, said = _run(WHILE_LOADING.format(name="typer").replace(pressed, taken), ["--version"])
    assert (status, shown, said) == (130, "", "winch-friction: interrupted\n")


def test_an_interrupt_when_all_is_done_says_nothing():
    status, shown, said = _run(WHEN_DONE, ["--version"])
    assert shown.startswith("winch-friction ")
    assert (status, said) == (-signal.SIGINT, "")


def test_an_interrupt_that_the_caller_ignores_stays_ignored():
    """As of a command behind `&` in a script, or under nohup."""
    ignored = "import signal; signal.signal(signal.SIGINT, signal.SIG_IGN)\n"
    status, shown, said = _run(ignored + WHILE_LOADING.format(name="typer") + WHEN_DONE, ["--version"])
    assert (status, said) == (0, "")
    assert shown.startswith("winch-friction ")


def test_a_closed_stderr_is_no_traceback():
    code = "import os; os.close(2)\n" + WHILE_LOADING.format(name="typer")
    assert _run(code, ["list"])[0] == 130


def test_the_entry_point_is_the_module_too():
    for module in ("winch_friction", "winch_friction.cli.entry"):
        done = subprocess.run([sys.executable, "-m", module, "--version"], capture_output=True, text=True, timeout=60)
        assert (done.returncode, done.stderr) == (0, "")
        assert done.stdout.startswith("winch-friction ")


# an interrupt that a library loses while it works: in a destructor, or where it makes an error of it
LOST = """
import os, signal, time
import winch_friction.cli.list as verb
class Held:
    def __del__(self):
        os.kill(os.getpid(), signal.SIGINT)
        for _ in range(1000):
            pass
def work(*args, **kwargs):
    {how}
verb.show_table = work
"""
IN_A_DESTRUCTOR = "held = Held(); del held; time.sleep(5.0)"
AS_ANOTHER_ERROR = "held = Held(); del held; raise RuntimeError('no compiled object yet')"


@pytest.mark.parametrize("how", [IN_A_DESTRUCTOR, AS_ANOTHER_ERROR])
def test_an_interrupt_that_a_library_loses_ends_the_work_all_the_same(how):
    """Compilers dispose of what they hold: one in 20 first simulations went on for 12 s, or called itself a defect."""
    status, _, said = _run(LOST.format(how=how), ["list", "terms"])
    assert (status, said.lstrip("\n")) == (130, "winch-friction: interrupted\n")
