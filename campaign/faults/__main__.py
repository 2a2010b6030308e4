"""`python -m campaign.faults`."""

import sys

from campaign.faults.study import main  # the workers import it by that name

if __name__ == "__main__":
    sys.exit(main())
