# The line of progress: cut to the terminal's width, and not there where standard error is no terminal.
source "$(dirname "$0")/../lib.sh"
needs script bsdutils
export LC_ALL=C.UTF-8
seed "$ball" --set 'grid.counts=[100,50,50]' --set grid.spacing=0.02 -o seeds

script -qec 'stty cols 30 rows 10; expand --complete seeds -o grid' /dev/null </dev/null >shown
python3 - <<'PYTHON'
import re
lines = [line for line in re.split(r"[\r\n]+", re.sub(r"\x1b\[K", "", open("shown").read())) if line]
assert any("conversions"[:3] in line or line.startswith("expand:") for line in lines), lines
assert max(map(len, lines)) == 29, lines
PYTHON
expect 0 '' '' -- expand --complete seeds -o again
cmp grid again
