# hapgrid init: in each language, make in the new folder leaves a grid with the same records, and make play plays it
# to the snaps that the closed form has. From the build's folder, and from an installation.
source "$(dirname "$0")/../lib.sh"

refusals "$here/init.tsv"
nothing_left there
rm -r there link
nothing_left .
expect 0 'json: a model in C; cd json && make && make play' '' -- hapgrid init json --lang c
rm -r json
(($(hapgrid init --help | wc -L) <= 80)) || fail 'the help is wider than 80 columns'

# made FOLDER HAPGRID OPTION...: what make and make play do in a new folder. The filters are not in the PATH.
made() (
  folder=$1 hapgrid=$2
  shift 2
  "$hapgrid" init "$folder" "$@" >said
  PATH=/usr/bin:/bin
  make -C "$folder" JOBS=1 >made.out 2>made.err || fail "$(cat made.out made.err)"
  local verdict
  for verdict in 'verify: fine: 1[0-9] checks' 'check-model: fine: \(9\|10\) checks.*'; do  # a process has one more
    grep -qx "$verdict" made.err || fail "$folder: not '$verdict': $(cat made.err)"
  done
  cp "$folder/$folder.grid" "$folder.first"
  make -C "$folder" play >made.out 2>&1 || fail "$(cat made.out)"
  make -C "$folder" -q || fail "$folder: make has something left to do"
  cmp "$folder.first" "$folder/$folder.grid"
  # At y = 7.5, k/b = 125 / (1 + y²/R²) mm², and the bead changes its side at |x| = 2 (-P/3)^(3/2) / (k/b), late;
  # C looks every 10/64 mm, in Python every 10/16.
  python3 - "$folder/$folder.log" <<'PYTHON'
import sys
lines = [line.split("\t") for line in open(sys.argv[1])]
x, s = (lines[0].index(name) for name in ("x", "s0"))
rows = [(float(line[x]), float(line[s])) for line in lines[1:]]
snaps = [row[0] for before, row in zip(rows, rows[1:]) if before[1] * row[1] < 0]
stiffness = 125 / (1 + 0.75**2)
late = 2 * ((100 - stiffness) / 3)**1.5 / stiffness
step = 10 / 16 if "python" in sys.argv[1] else 10 / 64
assert len(snaps) == 2 and 0 < snaps[0] - late < step and 0 < -snaps[1] - late < step, (snaps, late)
PYTHON
)

languages=(c python c++)
if command -v gfortran >/dev/null; then languages+=(fortran); else missing gfortran; fi
if command -v node >/dev/null; then languages+=(node); else missing node; fi
for language in "${languages[@]}"; do
  folder=my_${language/++/xx}
  made "$folder" hapgrid --lang "$language"
  dump "$folder/$folder.grid" >"$folder.dump"
  # What is stored with a state comes after it and its links, which are the same. States differ by rounding, and by what
  # the descent of the one in Python leaves: 1e-9 N, over a stiffness of 0.05 N/mm and more, a few 1e-8 mm.
  python3 - my_c.dump "$folder.dump" <<'PYTHON'
import sys
a, b = ([line.split("\t") for line in open(name) if line[0] != "#"] for name in sys.argv[1:])
assert len(a) == len(b) > 144, (len(a), len(b))
for x, y in zip(a, b):
    assert x[:4] == y[:4] and x[5:31] == y[5:31] and abs(float(x[4]) - float(y[4])) < 1e-7, (x, y)
PYTHON
done

# On another machine, hapgrid is elsewhere: make finds it in the PATH. What it makes is none of git's business.
cp -r my_c moved
sed -i 's|^HAPGRID ?=.*|HAPGRID ?= /gone/hapgrid|' moved/Makefile
make -C moved clean >/dev/null
make -C moved JOBS=1 >made.out 2>made.err || fail "$(cat made.out made.err)"
cmp my_c/my_c.grid moved/my_c.grid
touch moved/kept.c
python3 - moved <<'PYTHON'
import fnmatch, os, sys
patterns = open(sys.argv[1] + "/.gitignore").read().split()
kept = {name for name in os.listdir(sys.argv[1]) if not any(fnmatch.fnmatch(name, pattern) for pattern in patterns)}
assert kept == {".gitignore", ".github", "Makefile", "README.md", "Snakefile", "ci.sh", "kept.c", "my_c.c", "my_c.toml",
                "path.txt"}, kept
PYTHON
grep -q 'install.* git make *$' my_c/.github/workflows/grid.yml || fail 'packages of C'
grep -q 'git make python3$' my_python/.github/workflows/grid.yml || fail 'packages of Python'

# A CI gets an exit code, and a model that is wrong leaves no grid: here the force points the wrong way.
HAPGRID=hapgrid expect 0 '~.*' '~.*' -- my_c/ci.sh
make -s -C my_c clean
sed -i 's/force\[0\] = -k/force[0] = k/' my_c/my_c.c
expect 2 '~.*gradient +[0-9]+ forces +[1-9][0-9]* +broken.*' '~.*check-model: .*' -- make -C my_c JOBS=1
[[ ! -e my_c/my_c.grid && ! -e my_c/check.txt ]] || fail 'a model that is wrong has a grid'

# An installation, in a folder whose name means something to make, sed and the shell: one language that is compiled, and one
# that is not. Python's is what tests/fresh.sh makes with the wheel.
DESTDIR=$PWD/root cmake --install "$HAPGRID_BUILD" >install.log || fail "$(cat install.log)"
mv root "the \$root #1 & 'only'"
installed=$(find "$PWD"/the* -path '*/bin/hapgrid')
"$installed" init usual >said
cmp usual/usual.py <(sed 's/my_python/usual/g' my_python/my_python.py)
for language in c++ node; do
  [[ " ${languages[*]} " == *" $language "* ]] || continue
  folder=installed_${language/++/xx}
  made "$folder" "$installed" "--lang=$language"
  cmp <(dump "$folder/$folder.grid") "my_${language/++/xx}.dump"
done
same 'the headers' "${installed%/bin/hapgrid}/include" "$("$installed" include)"
