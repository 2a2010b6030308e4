"""Columns that bear one name: which of them a channel is, only the person knows."""

import numpy as np

from winch_friction.importing.draft import Draft
from winch_friction.importing.log import listed, own_name


def ask_twins(draft: Draft) -> None:
    """Ask which column a channel is where several bear its name and say something else."""
    columns = draft.logs[0].columns
    for channel, entry in draft.log_map.columns.items():
        twins = [each for each in columns if own_name(each.name) == own_name(entry.source)]
        if len(twins) > 1 and any(not np.array_equal(t.values, twins[0].values, equal_nan=True) for t in twins[1:]):
            draft.questions.append(
                f"{channel}: {listed(t.name for t in twins)} bear one name and differ; set {channel}.from to one"
            )
