# What the haptic thread asks of the system between its first tick and its last: the time to sleep
# until, and nothing else, with log, frames and all.
source "$(dirname "$0")/../lib.sh"
seed "$ball" --set grid.spacing=0.1 --set 'grid.counts=[20,10,10]' | expand --complete -o grid
for i in {-90..90} {90..-90}; do echo "$(printf '%de-2' "$i") 0.01 0"; done >path
strace -f -o trace play grid --device path:path --rate 500 --log log --frames frames --report report 2>err ||
  fail "play: $(cat err)"
python3 - <<'PYTHON'
import collections, re
lines = [line.rstrip("\n").split(None, 1) for line in open("trace")]
main = lines[0][0]
mine = [text for pid, text in lines if pid == main]
sleeps = [i for i, text in enumerate(mine) if text.startswith("clock_nanosleep(")]
assert len(sleeps) > 100, len(sleeps)
calls = collections.Counter(
    re.match(r"<\.\.\. (\w+) resumed|(\w+)\(|(\W.*)", text).group(0) for text in mine[sleeps[0]:sleeps[-1]])
calls = {call: n for call, n in calls.items()
         if call not in ("clock_nanosleep(", "<... clock_nanosleep resumed")}
# Without a vDSO clock (some virtual machines) the time itself is a call.
calls.pop("clock_gettime(", None)
assert not calls, calls
PYTHON
