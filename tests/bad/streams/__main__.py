"""python3 streams some|all|sanitized [CASES]: feeds bad shards to the filters; called by streams.sh in its directory.

some: each shard goes to one filter that reads it, not to all. sanitized: so, too, since the filters have
sanitizers, which take memory and time; and without the shards that are only cut, which bad/every-bit cuts at
every byte. CASES: only tests whose name has this.
"""

import sys

if sys.argv[1] != "sanitized":
    import damaged  # noqa: F401
import crafted
import messages
import accepted
import filters

filters.finish()
