# A step of a command that makes grids is computed anew by another hapgrid: one whose filters or sources have changed.
source "$(dirname "$0")/../lib.sh"
needs_python "rdkit, scipy" "python3-rdkit, python3-scipy"
/usr/bin/python3 -c 'import ctypes; ctypes.CDLL("libxtb.so.6")' 2>/dev/null || { missing libxtb6; exit 77; }

mkdir -p copy/filters
for folder in command molecule/hapgrid_molecule table/hapgrid_table docking/hapgrid_dock xtb; do
  mkdir -p "copy/$folder"
  cp -r "$HAPGRID_SOURCE/examples/$folder/." "copy/$folder"
done
cp "$HAPGRID_SOURCE/examples/molecule/elements.inc" copy/molecule
seed() { printf '#!/bin/sh\necho %s\n' "$1" >copy/filters/seed && chmod +x copy/filters/seed; }
seed 1

# computed PACKAGE: what two runs of its command compute, one after the other, in one folder.
computed() {
  HAPGRID_BIN=$PWD/copy/filters /usr/bin/python3 - "$1" <<'END' | xargs
import importlib, os, sys
sys.path[:0] = [os.path.abspath(f"copy/{name}") for name in ("molecule", "table", "docking")]
importlib.import_module(sys.argv[1] + (".steps" if sys.argv[1] == "hapgrid_molecule" else ".course"))
from hapgrid_command.work import Work


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
  same "$package" "first computed forgotten second" "$(computed "hapgrid_$package")"
done
for change in command/hapgrid_command/grid.py molecule/hapgrid_molecule/page.html table/hapgrid_table/cli.py docking/hapgrid_dock/cli.py filters; do
  if [[ $change == filters ]]; then seed 2; else echo '#' >>"copy/$change"; fi
  for package in molecule table dock; do
    anew="first second"
    # What docking shares with tables counts for it, too.
    case $change:$package in filters:* | command/*:* | "$package"/*:* | docking/*:dock | table/*:dock) anew="first computed forgotten second" ;; esac
    same "$package after a change of $change" "$anew" "$(computed "hapgrid_$package")"
  done
done
