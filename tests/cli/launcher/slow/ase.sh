# Atoms of ASE: what hapgrid init --lang ase makes leads to a grid that is fine.
source "$(dirname "$0")/../../lib.sh"
needs_python ase python3-ase

hapgrid init cluster --lang ase >/dev/null
# A row of points beside the cluster, from where nothing touches it to where nothing does.
make -C cluster JOBS=2 >out 2>err ||
  fail "$(cat out err)"
for verdict in 'check-model: fine: [0-9]+ checks(, but only .*)?' 'verify: (fine: 1[0-9] checks|not proved: .*)'; do
  grep -Eqx "$verdict" err || fail "not '$verdict': $(cat err)"
done
