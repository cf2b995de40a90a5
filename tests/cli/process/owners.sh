# What owners of model processes forget, and what they are told.
source "$(dirname "$0")/../lib.sh"

# A forgotten flush: the answer stays in a buffer of C's library, and nothing would happen for a minute.
cat >unflushed.c <<'C'
#include <stdio.h>
int main(void) {
  char line[4096];
  fgets(line, sizeof line, stdin);
  printf("{\"hapgrid\": 1, \"state_size\": 1, \"d_max\": 9, \"tolerance\": 1e-6}\n");
  while (fgets(line, sizeof line, stdin)) printf("{\"id\": 1, \"states\": [[0]]}\n");
  return 0;
}
C
"${CC:-cc}" -O1 unflushed.c -o unflushed
cat >unflushed.toml <<'TOML'
model = {process = ["./unflushed"], name = "unflushed"}
grid = {origin = [0, 0, 0], spacing = 1, counts = [2, 2, 2]}
TOML
hint="hapgrid: process './unflushed' waits for input, though it owes an answer: does it flush its output after each line \(in C fflush\(stdout\)\)\?"
seed unflushed.toml --allow-process -o seeds 2>said &
tool=$!
wait_for 20 'hint' grep -qE "^$hint$" said
kill $tool
wait $tool 2>/dev/null || true
# A model that is slow, or waits for something else, is told nothing.
cat >slow.py <<'PYTHON'
import sys, time
sys.stdin.readline()
time.sleep(3)
print('{"hapgrid": 1, "state_size": 1, "d_max": 9, "tolerance": 1e-6}', flush=True)
for line in sys.stdin:
    print('{"id": %s, "states": [[0]]}' % line.split('"id": ')[1].split(",")[0], flush=True)
PYTHON
sed 's/"\.\/unflushed"/"python3", "slow.py"/' unflushed.toml >slow.toml
expect 0 '' '' -- seed slow.toml --allow-process -o seeds

# A version: the grid keeps it. That another one does not go on with the grid is in models/version.sh.
cat >versions.py <<'PYTHON'
import types
import hapgrid


def model(version):
    return types.SimpleNamespace(
        description={"state_size": 1, "d_max": 2, "tolerance": 1e-6, "version": version}, known_states=lambda x: [[0]],
        convert=lambda s, x, d: s, force=lambda s, x: [0, 0, 0])


hapgrid.serve(lambda: model(open("version").read()))
PYTHON
sed 's/"\.\/unflushed"/"python3", "versions.py"/; s/"unflushed"/"versions"/' unflushed.toml >versions.toml
printf 1.0 >version
seed versions.toml --allow-process -o seeds
same 'the version in the header' 1.0 "$(header seeds modelVersion)"

# Copies of a model use all processors: the linear algebra of each gets one thread, unless its owner wants more.
sed 's/open("version").read()/"-".join(os.environ[f"{which}_NUM_THREADS"] for which in ("OMP", "OPENBLAS", "MKL"))/; 1i import os' \
  versions.py >threads.py
sed 's/versions\.py/threads.py/' versions.toml >threads.toml
env -u OMP_NUM_THREADS -u OPENBLAS_NUM_THREADS -u MKL_NUM_THREADS "$HAPGRID_BIN/seed" threads.toml --allow-process -o pinned
same 'the threads of each copy' 1-1-1 "$(header pinned modelVersion)"
env -u OPENBLAS_NUM_THREADS -u MKL_NUM_THREADS OMP_NUM_THREADS=3 "$HAPGRID_BIN/seed" threads.toml --allow-process -o three
same 'the threads that the owner wants' 3-1-1 "$(header three modelVersion)"
