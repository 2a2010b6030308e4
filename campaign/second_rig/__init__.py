"""A second independent winch: motion is prescribed, the rope is a spring, the balance of torques gives the pressures.

It shares no equation, no simulator and no constant with the package or with `campaign.rig`, and imports nothing of
either: it only writes files in the documented formats. `write_set(folder, SETS[key], seed)` writes one data set.
"""

from campaign.second_rig.files import write_set
from campaign.second_rig.sets import SETS, Set

__all__ = ["SETS", "Set", "write_set"]
