"""Layers of the drum as a log counts them: a run counts from 1, the innermost; a log that has a layer 0 is asked."""

import numpy as np

from winch_friction.importing.draft import Draft


def ask_layers(draft: Draft) -> None:
    """Ask whether a log that has a layer 0 counts from it, once the person has said what they know."""
    if "wire_layer" not in draft.log_map.columns:
        return
    layers = np.concatenate([each.columns.get("wire_layer", np.zeros(0)) for each in draft.converted()])
    layers = layers[np.isfinite(layers)]
    if len(layers) and round(float(layers.min())) < 1:
        # a question of its size is this one
        draft.questions = [each for each in draft.questions if not each.startswith("wire_layer:")]
        draft.questions.append(
            f"wire_layer: '{draft.log_map.columns['wire_layer'].source}' has a layer {layers.min():g}, and layers "
            "count from 1, the innermost: --set wire_layer.add=1 if this log counts from 0, else take it out of the map"
        )
