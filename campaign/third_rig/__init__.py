"""A third independent winch: kinematics in, pressures out, every effect sized to a trace that can fairly be found.

An outside examiner wrote it. It shares no equation, no simulator and no constant with the
package, with `campaign.rig` or with `campaign.second_rig`, and imports nothing of them: it only writes files in the
documented formats. `write_set(folder, SETS[key], draw)` writes one data set and the runs that came after it.
"""

from campaign.third_rig.files import Truth, write_set
from campaign.third_rig.sets import SETS, Set

__all__ = ["SETS", "Set", "Truth", "write_set"]
