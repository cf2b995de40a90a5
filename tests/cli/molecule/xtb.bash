# shellcheck shell=bash
# What the tests of prepared molecules share: values from their files, and the program xtb beside them.
sanitized && skip "nothing in it has sanitizers"
needs xtb xtb
# The system's Python, as hapgrid molecule starts it.
/usr/bin/python3 -c 'import jinja2, rdkit, scipy' 2>/dev/null ||
  { missing "python3-jinja2, python3-rdkit or python3-scipy"; exit 77; }
/usr/bin/python3 -c 'import ctypes; ctypes.CDLL("libxtb.so.6")' 2>/dev/null ||
  { missing libxtb6; exit 77; }
export OMP_NUM_THREADS=1

# word FILE FRAME KEY: a value in the comment line of a frame, counted from 1.
word() {
  awk -v frame="$2" -v key="$3=" '
    NF == 1 { n++; getline; if (n == frame) for (i = 1; i <= NF; i++)
      if (index($i, key) == 1) print substr($i, length(key) + 1) }' "$1"
}

# frame FILE FRAME: prints one frame.
frame() { awk -v frame="$2" 'NF == 1 { n++ } n == frame' "$1"; }

# within WHAT VALUE LOW HIGH
within() {
  awk -v v="$2" -v low="$3" -v high="$4" 'BEGIN { exit !(v != "" && v >= low && v <= high) }' ||
    fail "$1: '$2' is not between $3 and $4"
}

# xtb_energy FILE FRAME: the energy that the program xtb gives, hartree. METHOD is its option.
METHOD=(--gfn 2)
xtb_energy() {
  rm -rf run && mkdir run && frame "$1" "$2" >run/a.xyz
  (cd run && xtb a.xyz "${METHOD[@]}" --acc 0.01 2>/dev/null) | awk '/TOTAL ENERGY/ { print $4 }'
}

# energies FILE FRAME...: dE must be what xtb computes, to 1e-3 kJ/mol. The coordinates have 8 decimals,
# which are worth less than 1e-5.
energies() {
  local file=$1 start frame got
  shift
  start=$(xtb_energy "$file" 1)
  for frame in "$@"; do
    got=$(xtb_energy "$file" "$frame")
    within "dE of $file, frame $frame, less xtb's" "$(
      awk -v a="$start" -v b="$got" -v dE="$(word "$file" "$frame" dE)" \
        'BEGIN { printf "%.6f", dE - (b - a) * 2625.4996394799 }')" -0.001 0.001
  done
}

# turning_points FILE START: the same of its minima and saddles, to 0.01 kJ/mol above START's frame. $seen is their nimag.
turning_points() {
  local n start got
  start=$(xtb_energy "$2" 1) seen=
  for n in $(awk 'NF == 1 { n++; getline; if (/nimag=/) print n }' "$1"); do
    seen+=$(word "$1" "$n" nimag)
    got=$(awk -v a="$start" -v b="$(xtb_energy "$1" "$n")" 'BEGIN { print (b - a) * 2625.4996394799 }')
    within "dE of frame $n of $1 less xtb's" "$(awk -v a="$(word "$1" "$n" dE)" -v b="$got" 'BEGIN { print a - b }')" -0.01 0.01
  done
}

# over NAME LOW HIGH: the hand's way leads over all barriers and back to t = 0, without a snap.
over() {
  play "$1/$1.grid" --device "path:$(ls "$1"/path-*.txt)" --log log 2>said || fail "$(cat said)"
  awk -F'\t' -v low="$2" -v high="$3" 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next }
    { t = $at["s0"]; if (t < least) least = t; if (t > most) most = t; snaps += $at["snap"]; e = $at["own_energy"]; if (e > top) top = e }
    END { print least, most, t, top; exit !(least < low + 0.02 && most > high - 0.02 && t * t < 1e-4 && snaps == 0) }' log ||
    fail "$1: not over and back"
  grep -q "BROKEN\|broken" "$1/verify.txt" && fail "$(cat "$1/verify.txt")"
  return 0
}
