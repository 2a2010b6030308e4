"""How many model evaluations a fit takes: variable projection beside Box's complex method, on the same table.

python bench/identification.py
"""

from typing import Any

from pairs import figure, seconds

from winch_friction.identification.fit import fit
from winch_friction.identification.motor_models import initial_model, motor_model_named
from winch_friction.identification.supplier_file import read_supplier_table
from winch_friction.records.paths import config_directory

MODEL, TABLE = "MJ4", "a6vm215_generated.csv"


def measure() -> dict[str, Any]:
    """Evaluations of both methods, their ratio, and the costs that they reach."""
    table = read_supplier_table(config_directory() / "suppliers" / TABLE)
    described = motor_model_named(MODEL)
    start, data = initial_model(described, float(table.displacement.max())), table.fit_data()
    found: dict[str, Any] = {}
    times = {way: seconds(lambda w=way: found.update({w: fit(start, data, method=w)})) for way in METHODS}
    ours, theirs = found["least_squares"], found["complex"]
    against = f"complex method, {theirs.evaluations} evaluations, cost {theirs.cost / ours.cost:.6f} x ours"
    ratio = theirs.evaluations / ours.evaluations
    return {
        "fit of MJ4: model evaluations": figure(ours.evaluations, "1", against, ratio, "ratio >= 100"),
        "fit of MJ4: time": figure(
            times["least_squares"],
            "s",
            f"complex method, {times['complex']:.3g} s",
            times["complex"] / times["least_squares"],
        ),
    }


METHODS = ("least_squares", "complex")

if __name__ == "__main__":
    print(measure())
