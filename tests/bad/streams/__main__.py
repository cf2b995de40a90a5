"""python3 streams some|all|sanitized [CASES]: feeds bad shards to the filters; called by streams.sh in its directory.

some: each shard goes to one filter that reads it, not to all. sanitized: so, too, since the filters have
sanitizers, which take memory and time. CASES: only tests whose name has this.
"""

import damaged
import crafted
import messages
import accepted
import filters

filters.finish()
