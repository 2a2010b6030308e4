"""What came out of a replay, in a few numbers for people and machines."""

from dataclasses import asdict
from typing import Any

import numpy as np

from winch_friction.replay.recording import Replayed


def summary(replayed: Replayed) -> dict[str, Any]:
    """Plain types: length, states, torque levels, learned parameters, and the comparison with live outputs."""
    compensator, estimator = replayed.compensator, replayed.estimator
    torque = np.abs(compensator["friction_torque"])
    return {
        "recording": compensator.name,
        "samples": len(compensator),
        "duration_s": float(compensator.time[-1] - compensator.time[0]),
        "active_share": float(np.mean(compensator.aside["state"] == "active")),
        "feedforward_rms_Nm": float(np.sqrt(np.mean(torque**2))),
        "feedforward_peak_Nm": float(torque.max()),
        "accepted_share": float(np.mean(estimator.aside["state"] != "rejected")),
        "nis_share_inside": replayed.status.get("nis_share_inside"),
        "parameters": [_parameter(each) for each in replayed.parameters],
        "live": [{**asdict(each), "equal": each.equal} for each in replayed.live],
    }


def _parameter(each: Any) -> dict[str, Any]:
    return {
        "parameter": each.name,
        "unit": each.unit,
        "seed": each.seed_value,
        "learned": each.value,
        "sigma": each.std,
        "status": each.status,
    }
