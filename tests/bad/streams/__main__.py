"""python3 streams SLOW [CASES]: feeds bad shards to the filters; called by streams.sh in its directory.

SLOW: the filters have sanitizers, which take memory and time. CASES: only tests whose name has this.
"""

import damaged
import crafted
import messages
import accepted
import filters

filters.finish()
