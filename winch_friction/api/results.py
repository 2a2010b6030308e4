"""What the jobs return: the result behind a few properties, with a summary in words and a table in a notebook."""

from pathlib import Path
from typing import Any

from winch_friction.physics.channels import beside
from winch_friction.physics.frames import html_table, library
from winch_friction.physics.friction.model import FrictionModel
from winch_friction.physics.signals import Run


class Fit:
    """A fitted model: `model` with covariance, `rms` in N m per motor, `details` of the method.

    >>> import winch_friction as wf
    >>> found = wf.fit("a6vm215_generated", motor="mj4")
    >>> found.model.covariance.shape, found.rms < 0.5, found.summary()[:30]
    ((5, 5), True, 'motor_viscous + motor_turbulen')
    """

    def __init__(self, model: FrictionModel, rms: float, details: Any) -> None:
        self.model, self.rms, self.details = model, rms, details

    def summary(self) -> str:
        """What was fitted and how well, in one line."""
        terms, count = " + ".join(self.model.term_names), len(self.model.values)
        return f"{terms}: {count} parameters, RMS {self.rms:.3g} N m per motor"

    def __repr__(self) -> str:
        return f"Fit: {self.summary()}"

    def _repr_html_(self) -> str:
        return f"<p>{self.summary()}</p>{self.model._repr_html_()}"


class Replay:
    """A recording through compensator and estimator: outputs as runs, the learned model, its parameters.

    >>> import tempfile, winch_friction as wf
    >>> crane, model = wf.load_crane("crane_150t"), wf.load_model("a6vm215_crane2")
    >>> result = wf.replay(wf.simulate("ahc_55t_215", crane, model, duration=10.0).run, crane, model)
    >>> result.compensator["friction_torque"].shape == result.estimator["friction_torque"].shape
    True
    >>> result.parameters.loc["C3", "unit"], result.model.crane, result.summary().split(",")[0]
    ('N*m', 'crane_150t', '10 s')
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     result.to_html(f"{folder}/replay.html").stat().st_size < 5e6
    True
    """

    def __init__(self, result: Any, seed: FrictionModel) -> None:
        self.result, self.seed = result, seed

    @property
    def model(self) -> FrictionModel:
        """The learned model."""
        return self.result.model

    @property
    def compensator(self) -> Run:
        """What was fed forward: `friction_torque` N m, `speed` rad/s and more, over the recording's time."""
        return self.result.compensator

    @property
    def estimator(self) -> Run:
        """What the estimator gave: `friction_torque` N m, each parameter and its `_std`."""
        return self.result.estimator

    @property
    def parameters(self) -> Any:
        """One row per parameter: unit, seed, learned, sigma, status."""
        rows = self._content()["parameters"]
        return library("pandas", "desk").DataFrame(rows).set_index("parameter")

    def _content(self) -> dict[str, Any]:
        from winch_friction.replay.summary import summary

        return summary(self.result)

    def summary(self) -> str:
        """Length, share of time in action, level of the torque and what was learned, in words."""
        content = self._content()
        learned = [p for p in content["parameters"] if p["status"] in ("learning", "learned", "frozen")]
        names = ", ".join(
            f"{p['parameter']} {p['seed']:.3g} -> {beside(p['learned'], p['sigma']):.3g} {p['unit']}" for p in learned
        )
        return (
            f"{content['duration_s']:.0f} s, feedforward active {content['active_share']:.0%} of the time, "
            f"{content['feedforward_rms_Nm']:.3g} N m RMS, {content['feedforward_peak_Nm']:.3g} at most; "
            f"learned: {names or 'nothing beyond the seed'}"
        )

    def to_html(self, path: str | Path) -> Path:
        """Write the report page, which works offline; returns its path."""
        from winch_friction.report.replay_page import write_replay_page

        recorded = {"recording": self.compensator.name, "seed model": self.seed.name}
        return write_replay_page(Path(path), self.result, self.seed, recorded)

    def __repr__(self) -> str:
        return f"Replay: {self.summary()}"

    def _repr_html_(self) -> str:
        frame = self.parameters
        return html_table(repr(self), ["parameter", *frame.columns], frame.reset_index().values.tolist())


class Check:
    """Whether runs can be a crane's: the sentence, the findings, what to log next.

    >>> import winch_friction as wf
    >>> crane, model = wf.load_crane("crane_150t"), wf.load_model("a6vm215_crane2")
    >>> run = wf.simulate("ahc_55t_215", crane, model, duration=30.0).run
    >>> wrong = wf.from_frame(run.to_frame().assign(hook_load=run["hook_load"] / 1e3), "kg for t")
    >>> result = wf.check([wrong], crane, model)
    >>> result.plausible, "hook_load" in result.summary(), result.findings["severity"].iloc[0]
    (False, True, 'error')
    """

    def __init__(self, result: Any) -> None:
        self.result = result

    @property
    def plausible(self) -> bool:
        """Whether the runs can be the crane's."""
        return self.result.plausible

    @property
    def findings(self) -> Any:
        """One row per finding, the gravest first."""
        return library("pandas", "desk").DataFrame([each.content() for each in self.result.findings])

    def summary(self) -> str:
        """The verdict in one line: the most likely mistake, or that there is none."""
        return self.result.sentence

    def __repr__(self) -> str:
        return f"Check: {self.summary()}"

    def _repr_html_(self) -> str:
        rows = [(each.severity, each.sentence) for each in self.result.findings]
        return html_table(self.summary(), ("severity", "finding"), rows)


class Gap:
    """What the discrepancy workflow found: the verdict, the effects, the repaired model and the proof.

    >>> import tempfile, numpy as np, winch_friction as wf
    >>> crane, truth = wf.load_crane("emps"), wf.load_model("emps_symmetric").with_values({"T_0": 0.0})
    >>> def logged(k):
    ...     time = 0.02 * np.arange(3000)
    ...     speed = 0.15 * np.sin(2 * np.pi * time / (6 + k)) * np.sin(2 * np.pi * time / 37 + k)
    ...     columns = {"time": time, "motor_speed": speed, "motor_torque": 0 * time, "hook_load": 0 * time}
    ...     noise = np.random.default_rng(k).normal(0.0, 0.3, 3000)
    ...     drive = crane.inertia * np.gradient(speed, time) + wf.torque(truth, wf.from_frame(columns), crane) + noise
    ...     return wf.from_frame({**columns, "motor_torque": drive}, f"run {k}")
    >>> found = wf.gap([logged(k) for k in range(5)], crane, wf.load_model("emps_viscous"))
    >>> found.verdict in ("missing_effect", "ambiguous"), len(found.effects), len(found.model.terms) > 1
    (True, 1, True)
    >>> found.content()["schema"], "locked runs" in found.summary(), len(found.plot().data) > 0
    ('winch_friction.gap/2', True, True)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     found.to_html(f"{folder}/gap.html").stat().st_size < 5e6
    True
    """

    def __init__(self, result: Any) -> None:
        self.result = result

    @property
    def verdict(self) -> str:
        """missing_effect, nothing_missing, ambiguous, unexplained or insufficient."""
        return self.result.verdict

    @property
    def model(self) -> FrictionModel:
        """The repaired model; equal to the given one where nothing was added."""
        return self.result.model

    @property
    def effects(self) -> Any:
        """One row per missing effect: what it cannot be told from, its parameters with std and unit, the evidence."""
        rows = [
            {"effect": e["name"], "indistinguishable_from": ", ".join(e["indistinguishable_from"]),
             "parameters": ", ".join(f"{k} = {beside(p['value'], p['std']):.4g} ± {p['std']:.2g} {p['unit']}"
                                     for k, p in e["parameters"].items()),
             **e["evidence"]}
            for e in self.content()["effects"]
        ]  # fmt: skip
        columns = ["effect", "indistinguishable_from", "parameters", "p_value", "cv_gain", "selection_frequency"]
        frame = library("pandas", "desk").DataFrame(rows, columns=None if rows else columns)
        return frame.set_index("effect")

    def content(self) -> dict[str, Any]:
        """The content of gap.json (docs/interfaces.md)."""
        return self.result.content()

    def summary(self) -> str:
        """The verdict in a sentence, and the gap on the locked runs before and after."""
        from winch_friction.report.gap import verdict_sentence

        gap = self.content()["gap"]
        locked, unit = gap["holdout"], gap["unit"]
        if locked["before"] is None:
            return verdict_sentence(self.result)
        return (
            f"{verdict_sentence(self.result)} Gap on locked runs: {locked['before']:.3g} {unit} before, "
            f"{locked['after']:.3g} after; noise {locked['noise_floor']:.3g} {unit}."
        )

    def plot(self) -> Any:
        """The gap of the locked runs by speed, before and after, as a plotly `Figure`."""
        from winch_friction.report.gap_plots import speed_plot
        from winch_friction.report.plots import plotly_figure

        return plotly_figure(speed_plot(self.result))

    def to_html(self, path: str | Path) -> Path:
        """Write the report page, which works offline; returns its path."""
        from winch_friction.report.gap import write_gap_report

        return write_gap_report(Path(path), self.result)

    def __repr__(self) -> str:
        return f"Gap: {self.summary()}"

    def _repr_html_(self) -> str:
        frame = self.effects
        return html_table(self.summary(), ["effect", *frame.columns], frame.reset_index().values.tolist())
