"""What a fit takes: variable projection beside Box's complex method and differential evolution, on the same table."""

from typing import Any

import numpy as np
from scipy.optimize import differential_evolution

from bench.measuring import Row, paired, seconds
from winch_friction.identification.fit import fit, search_box
from winch_friction.identification.fit_data import CountedModel
from winch_friction.identification.motor_models import initial_model, motor_model_named
from winch_friction.identification.supplier_file import read_supplier_table
from winch_friction.records.strict_yaml import config_directory

MODEL, TABLE = "MJ4", "a6vm215_generated.csv"


def measure(smoke: bool = False) -> list[Row]:
    """Time and model evaluations of both methods, and the costs that they reach."""
    table = read_supplier_table(config_directory() / "suppliers" / TABLE)
    start, data = initial_model(motor_model_named(MODEL), float(table.displacement.max())), table.fit_data()
    ours = fit(start, data, method="least_squares")
    counted = CountedModel(start, data)
    box = list(zip(*search_box(start, data), strict=True))

    def evolved(generations: int = 1000) -> Any:
        return differential_evolution(counted.cost, box, seed=0, maxiter=generations)

    theirs, against = fit(start, data, method="complex"), "Box's complex method"
    fewer = theirs.evaluations / ours.evaluations
    evaluations = Row(
        "fit of MJ4: model evaluations", ours.evaluations, "1", against, theirs.evaluations, fewer, at_least=100.0
    )
    if smoke:
        assert np.isfinite(evolved(2).fun)
        return [Row("fit of MJ4: time", seconds(lambda: fit(start, data, method="least_squares")), "s"), evaluations]
    time = paired(
        lambda: fit(start, data, method="least_squares"), lambda: fit(start, data, method="complex"), repeats=3
    )
    faster, spread = time.inverse
    note = f"the complex method's cost is {theirs.cost / ours.cost:.6f} x ours"
    evolution = evolved()
    evolving = paired(lambda: fit(start, data, method="least_squares"), evolved, repeats=1)
    how = f"scipy's defaults, {evolution.nfev} evaluations; its cost is {evolution.fun / ours.cost:.6f} x ours"
    return [
        Row("fit of MJ4: time", time.ours, "s", against, time.theirs, faster, spread, at_least=50.0, note=note),
        Row(
            "fit of MJ4: time beside evolution", evolving.ours, "s", "differential_evolution", evolving.theirs,
            *evolving.inverse, at_least=50.0, note=how,
        ),
        evaluations,
    ]  # fmt: skip
