"""Pages to look at, from the quickest results that have everything on them."""

from pathlib import Path

import numpy as np

import winch_friction as wf

AXE = Path(__file__).with_name("axe.min.js")
SIZES = (1400, 768, 420)  # px: a desk, a tablet, a phone
SCHEMES = ("light", "dark")


def violations(page):
    """What axe-core finds wrong with the page, in words."""
    page.add_script_tag(path=AXE)
    found = page.evaluate("axe.run()")["violations"]
    return [f"{each['id']}: {each['nodes'][0]['html'][:120]}" for each in found]


def small_gap():
    """Five minutes of an electric drive whose model lacks Coulomb friction: found in half a second."""
    crane, truth = wf.load_crane("emps"), wf.load_model("emps_symmetric").with_values({"T_0": 0.0})
    return wf.gap([_logged(k, crane, truth) for k in range(5)], crane, wf.load_model("emps_viscous"))


def _logged(number, crane, truth):
    time = 0.02 * np.arange(3000)
    speed = 0.15 * np.sin(2 * np.pi * time / (6 + number)) * np.sin(2 * np.pi * time / 37 + number)
    columns = {"time": time, "motor_speed": speed, "motor_torque": 0 * time, "hook_load": 0 * time}
    noise = np.random.default_rng(number).normal(0.0, 0.3, len(time))
    friction = wf.torque(truth, wf.from_frame(columns), crane)
    drive = crane.inertia * np.gradient(speed, time) + friction + noise
    return wf.from_frame({**columns, "motor_torque": drive}, f"run {number}")
