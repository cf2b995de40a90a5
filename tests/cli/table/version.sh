# A step of a command that makes grids is computed anew by another hapgrid: one whose filters or sources have changed.
source "$(dirname "$0")/../lib.sh"
needs_python "jinja2, rdkit, scipy" "python3-jinja2, python3-rdkit, python3-scipy"
/usr/bin/python3 -c 'import ctypes; ctypes.CDLL("libxtb.so.6")' 2>/dev/null || { missing libxtb6; exit 77; }

cp -r "$HAPGRID_BUILD/python" copy
mkdir copy/filters
seed() { printf '#!/bin/sh\necho %s\n' "$1" >copy/filters/seed && chmod +x copy/filters/seed; }
seed 1

# computed PACKAGE: what two runs of its command compute, one after the other, in one folder.
computed() {
  HAPGRID_BIN=$PWD/copy/filters PYTHONPATH=copy /usr/bin/python3 - "$1" <<'END' | xargs
import importlib, os, sys
importlib.import_module(f"hapgrid.apps.{sys.argv[1]}.steps")
from hapgrid.apps.common.work import Work


def compute():
    work.enter()
    work.write("made", "x")
    print("computed")
    return ["made"]


for run in "first", "second":
    print(run)
    work = Work("command", sys.argv[1], True)
    work.step("one", "", [], ["an option"], compute)
    if work.recall("other", 1) is None:
        print("forgotten")
    work.remember("other", 1, True)
    os.close(work._lock)  # as the end of a command does
END
}
for package in molecule table dock; do
  same "$package" "first computed forgotten second" "$(computed "$package")"
done
for change in common/grid.py molecule/page.html table/cli.py dock/cli.py filters; do
  if [[ $change == filters ]]; then seed 2; else echo '#' >>"copy/hapgrid/apps/$change"; fi
  for package in molecule table dock; do
    anew="first second"
    # What docking shares with tables counts for it, too.
    case $change:$package in filters:* | common/*:* | "$package"/*:* | dock/*:dock | table/*:dock) anew="first computed forgotten second" ;; esac
    same "$package after a change of $change" "$anew" "$(computed "$package")"
  done
done
