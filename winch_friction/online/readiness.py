"""What a service would else compile while a sample waits for it.

A model's functions are made at their first use: without a kept copy that takes 0.07 s of the first sample for the
feedforward and 0.4 s of the second one for learning, or of the one at which a running compensator takes over a model
of other terms. That is longer than the age limit.
"""

from collections.abc import Sequence

from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.friction.model import completed
from winch_friction.physics.winch.crane import Crane

ANSWERING = ("scalar_contributions",)  # functions of `CompiledTerms` that the feedforward asks for
LEARNING = ("scalar_torque", "scalar_torque_and_gradient")  # ... and the estimator
REMEMBERING = "scalar_state_rates"  # ... and both, of terms with a memory


def make_ready(model: FrictionModel, crane: Crane, groups: int, uses: Sequence[str]) -> None:
    """Compile what a service of this crane with so many motor groups `uses` of the model."""
    functions = completed(model, crane).compile(groups)
    for name in (*uses, *((REMEMBERING,) if functions.initial_states else ())):
        getattr(functions, name)
