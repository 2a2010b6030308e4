"""Friction of a hydraulic winch: compensated and learned online, identified offline, questioned always.

`import winch_friction as wf` is the public surface: the names in `__all__`, in SI, with an example each. They are
loaded when they are first used, so that a node pays for nothing it does not need. Everything else is private.
"""

import sys
from types import ModuleType

__version__ = "0.1.0"

# name -> module; each module documents what it gives with an example that is tested
_PUBLIC = {
    **dict.fromkeys(("from_frame", "read_run", "write_run"), "winch_friction.api.runs"),
    **dict.fromkeys(("load_crane", "load_model", "save_model"), "winch_friction.api.files"),
    **dict.fromkeys(("torque", "contributions", "jacobian", "friction_curve"), "winch_friction.api.evaluate"),
    **dict.fromkeys(("check", "fit", "gap", "replay", "simulate"), "winch_friction.api.work"),
    "Run": "winch_friction.physics.signals",
    "Sample": "winch_friction.physics.signals",
    "GroupSample": "winch_friction.physics.signals",
    "FrictionModel": "winch_friction.physics.friction.model",
    "Crane": "winch_friction.physics.winch.crane",
    "InputError": "winch_friction.physics.errors",
    "FeedforwardCompensator": "winch_friction.compensation",
    "FrictionEstimator": "winch_friction.estimation",
    "terms": "",  # the module winch_friction.terms: declare a term of your own
}
__all__ = sorted(_PUBLIC)


def __getattr__(name: str) -> object:
    """Load a public name when it is first used (PEP 562)."""
    if name not in _PUBLIC:
        raise AttributeError(f"module 'winch_friction' has no public name '{name}'; it has {', '.join(__all__)}")
    from importlib import import_module

    value = getattr(import_module(_PUBLIC[name]), name) if _PUBLIC[name] else import_module(f"winch_friction.{name}")
    globals()[name] = value
    return value


class _Surface(ModuleType):
    """The package as a module whose public names stay what they are: `replay` is also the name of a subpackage, which
    the import system would put in the function's place."""

    def __setattr__(self, name: str, value: object) -> None:
        if not (name in _PUBLIC and _PUBLIC[name] and isinstance(value, ModuleType)):
            super().__setattr__(name, value)


sys.modules[__name__].__class__ = _Surface


def __dir__() -> list[str]:
    return [*__all__, "__version__"]
