"""Pages to look at, from the quickest results that have everything on them."""

import itertools
import os
from dataclasses import asdict
from pathlib import Path
from types import SimpleNamespace

import numpy as np
from PIL import Image

import winch_friction as wf
from winch_friction.cli.demo.legs import voyage_legs
from winch_friction.cli.demo.measures import BINS, PhaseFigures
from winch_friction.cli.demo.page import sections
from winch_friction.cli.demo.plan import make_plan
from winch_friction.cli.demo.tuning import EfficiencySearch
from winch_friction.cli.main import run
from winch_friction.fleet.drift import find_steps, month_text, monthly
from winch_friction.fleet.fingerprint import TRAITS
from winch_friction.fleet.ledger import Outcome
from winch_friction.fleet.store import write_store
from winch_friction.records.strict_yaml import config_directory
from winch_friction.report.base import write_report
from winch_friction.report.fleet import write_fleet_report

QUICK = ("--resamples", "2", "--evaluations", "200", "-q")

AXE = Path(__file__).with_name("axe.min.js")
DESK, TABLET, PHONE = 1400, 768, 420  # px
SCHEMES = ("light", "dark")
INK = {"light": "#1d2126", "dark": "#e4e7ea"}  # of the plots' text


# the answers of all rules on a large page are megabytes; only what is wrong is fetched from the browser
RUN_AXE = """(rules) => axe.run({resultTypes: ["violations"], ...(rules ? {runOnly: rules} : {})}).then(
    ({violations}) => violations.map(({id, nodes}) => `${id}: ${nodes[0].html.slice(0, 120)}`))"""

# the rules that a change of the scheme can break: it changes colours alone
OF_COLOURS = ["color-contrast", "link-in-text-block"]

# a finger cannot hover: on a phone the buttons of a figure are always there, and may lie on no name of its legend
COVERED = """[...document.querySelectorAll(".js-plotly-plot")].flatMap((plot) => {
    const boxes = (name) => [...plot.querySelectorAll(name)].map((each) => each.getBoundingClientRect());
    return boxes(".legendtext, .annotation-text").filter((text) => boxes(".modebar-btn").some((button) =>
        Math.min(text.right, button.right) - Math.max(text.left, button.left) > 0.5 &&
        Math.min(text.bottom, button.bottom) - Math.max(text.top, button.top) > 0.5));
}).length"""


def violations(page, rules=None):
    """What axe-core finds wrong with the page, in words, by all its rules or by some."""
    if not page.evaluate("!!globalThis.axe"):
        page.add_script_tag(path=AXE)
    return page.evaluate(RUN_AXE, rules)


def keep_screenshot(page, kind, width, scheme):
    """With SCREENSHOTS=FOLDER in the environment: what is seen first, for docs/images/pages."""
    folder = os.environ.get("SCREENSHOTS")
    if folder:
        page.evaluate("scrollTo(0, 0)")
        name = Path(folder) / f"{kind}_{width}_{scheme}.png"
        page.screenshot(path=name)
        Image.open(name).convert("RGB").quantize(64).save(name, optimize=True)


def small_gap():
    """Five minutes of an electric drive whose model lacks Coulomb friction: found in half a second."""
    crane, truth = wf.load_crane("emps"), wf.load_model("emps_symmetric").with_values({"T_0": 0.0})
    return wf.gap([_logged(k, crane, truth) for k in range(5)], crane, wf.load_model("emps_viscous"))


def practice_page(folder):
    """The shipped example, quickly."""
    assert run(["identify", "practice", "practice_150t", "--out", str(folder), *QUICK]) == 0
    return folder / "report.html"


def check_page(folder):
    """One test of the shipped example."""
    test = config_directory() / "examples" / "practice_150t" / "test_02.parquet"
    assert run(["check", str(test), "--crane", "crane_150t", "--out", str(folder), "-q"]) == 0
    return folder / "check.html"


def replay_page(folder):
    """Half a minute of a sea."""
    crane, model = wf.load_crane("crane_150t"), wf.load_model("a6vm215_crane2")
    run_ = wf.simulate("ahc_55t_215", crane, model, duration=30.0).run
    return wf.replay(run_, crane, model).to_html(folder / "replay.html")


def compare_page(folder):
    """The two shipped winch models at one load."""
    out = folder / "compare.html"
    assert run(["compare", "a6vm215_crane1", "a6vm215_crane2", "--loads", "55", "--out", str(out)]) == 0
    return out


def fleet_page(folder):
    """Five cranes over a year and a half; one gets new seals in July 2024, one recording is broken."""
    rows, outcomes = [], []
    noise = np.random.default_rng(0)
    for crane, month, trait in itertools.product(range(5), range(18), TRAITS):
        jump = 15.0 if crane == 1 and month >= 6 and trait == "friction" else 0.0
        name, time = f"crane_{crane}", 1_704_884_400.0 + month * 30.44 * 86400.0
        rows.append({"crane": name, "recording": f"{month}", "time": time, "kind": "trait", "name": trait,
                     "value": jump + 0.3 * noise.standard_normal(), "std": 0.3, "unit": TRAITS[trait]})  # fmt: skip
    for crane in range(5):
        outcomes.append(Outcome(f"{crane}", f"crane_{crane}", f"{crane}.csv", 2 * (crane == 4), 0.1, {}, "no such run"))
    write_store(folder / "store", rows)
    series = {}
    for row in rows:
        series.setdefault((row["crane"], row["name"]), []).append((row["time"], row["value"], row["std"]))
    steps = [{**asdict(each), "month": month_text(each.month), "unit": TRAITS[each.trait]}
             for each in find_steps(monthly(series))]  # fmt: skip
    assert [(each["crane"], each["month"]) for each in steps] == [("crane_1", "2024-07")]
    content = {"steps": steps, "unlike": [], "notes": []}
    return write_fleet_report(folder / "fleet.html", "check", outcomes, content, folder / "store")


def demo_page(folder):
    """A voyage that was recorded nowhere: the page's own numbers are what counts here."""
    plan = make_plan(folder, "ahc_irregular", voyage_legs("ahc_irregular"), 0.84, 40.0, 1, 1.3)
    time = np.arange(0.0, 40.0, 0.02)
    wave = np.sin(2 * np.pi * time / 9.0)
    truth = np.column_stack([time, 0.009 * wave, np.cos(wave), 450.0 * np.sign(wave)])
    fed = np.column_stack([time, 400.0 * np.sign(wave), wave, wave])
    part = SimpleNamespace(truth=truth, fed=fed)
    rows = [
        PhaseFigures(phase, 0.002, 0.003, (9.0,) * len(BINS), (0.1,) * len(BINS), 0.78 * phase.feedforward.enabled)
        for phase in plan.phases
    ]
    recording = SimpleNamespace(phases=lambda count: [part] * count)
    search = EfficiencySearch((0.8, 0.84, 0.9), (0.003, 0.002, 0.004))
    page = sections(plan, recording, rows, [], [], search)
    return write_report(folder / "demo.html", "The loop closes", page, "ahc_irregular, sea 1")


def _logged(number, crane, truth):
    time = 0.02 * np.arange(3000)
    speed = 0.15 * np.sin(2 * np.pi * time / (6 + number)) * np.sin(2 * np.pi * time / 37 + number)
    columns = {"time": time, "motor_speed": speed, "motor_torque": 0 * time, "hook_load": 0 * time}
    noise = np.random.default_rng(number).normal(0.0, 0.3, len(time))
    friction = wf.torque(truth, wf.from_frame(columns), crane)
    drive = crane.inertia * np.gradient(speed, time) + friction + noise
    return wf.from_frame({**columns, "motor_torque": drive}, f"run {number}")


# page kind -> how to make one; `gap`'s is shared by other tests
KINDS = {"gap": None, "replay": replay_page, "compare": compare_page, "identify": practice_page, "check": check_page,
         "fleet": fleet_page, "demo": demo_page}  # fmt: skip
