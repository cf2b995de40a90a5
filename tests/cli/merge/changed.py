"""changed.py LOSSY: the same shard with one number moved by 1000 steps, and sealed again."""

import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import shard

with open(sys.argv[1], "rb") as file:
    messages = shard.decode(file.read())
chunk = messages[1]["coded"]
assert chunk["shift"][0] == 255
row = chunk["rows"] // 2
# Two planes, so that there is room for it: 1000 steps are 2000 in zigzag.
while chunk["planes"][0] < 2:
    chunk["residuals"] += [0] * chunk["rows"]
    chunk["planes"][0] += 1
chunk["residuals"][chunk["rows"] + row] ^= 2000 >> 8
sys.stdout.buffer.write(shard.seal(messages))
