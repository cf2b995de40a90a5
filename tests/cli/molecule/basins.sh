# Paths that go on behind their saddles: the committed one, and `hapgrid molecule --basins` with GFN-FF.
source "$(dirname "$0")/../lib.sh"
molecules=$HAPGRID_SOURCE/examples/molecule

# 1,2-Dichloroethane rests in anti and in both gauche conformations, and stays where a push has brought it.
toml=$molecules/dichloroethane/dichloroethane.toml
molecule-check "$toml" >sane || fail "$(cat sane)"
same "minima" "0.00 0 5.77 -0.314814815 5.77 0.314814815" "$(awk '$1 == "minimum" { print $2, $3 }' sane | xargs)"
refuses 'molecule-check: --xyz: numbers from -0\.5 to 0\.5' -- molecule-check "$toml" --xyz=-0.6
seed "$toml" --set grid.spacing=1.1 --set 'grid.counts=[13,11,11]' --set 'grid.origin=[-6.6,-5.5,-5.5]' |
  expand --complete -o grid
verify grid --recompute 100 >report 2>verdict || fail "$(cat verdict)"
sed -n '3,$p' "$molecules/dichloroethane/path-there-and-back.txt" >path
play grid --device path:path --traversal model --log log 2>/dev/null
awk -F'\t' 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next }
  { t = $at["s0"]; if (t > 0.3 || t < -0.3) if ($at["force_x"] == 0) stays++ }
  END { exit !(stays > 500 && t == 0) }' log || fail "not to gauche and back"
if [[ -x $HAPGRID_BUILD/bench/bench_basins ]]; then
  "$HAPGRID_BUILD/bench/bench_basins" grid "$HAPGRID_BUILD/models" 40 >ends || true  # this grid is coarse
  grep -qE '^40 pushes: 0 end in no known state, (2[89]|3.|40) where the model does; [1-9]' ends || fail "$(cat ends)"
fi
source "$here/xtb.bash"

# 1,3-Difluoropropane: two equal torsions. Where both are behind a saddle the sum is wrong, so one is left out. The
# minima and saddles of the other are xtb's, and the probe leads it over a barrier.
hapgrid molecule --push --smiles FCCCF --basins --method gfnff --spacing 2 -o fluoro --quiet >line || fail "no grid"
grep -qP '^C2-C3-C4-F5\t.*\tno\tthe minima at t = .* together are .* kJ/mol by xtb, .* by the sum$' fluoro/rotors.tsv ||
  fail "$(cat fluoro/rotors.tsv)"
METHOD=(--gfnff)
turn=fluoro/F1-C2-C3-C4.xyz
turning_points "$turn" fluoro/conformation.xyz
[[ $seen =~ ^(1?0)(10)+1?$ ]] || fail "minima and saddles do not alternate: $seen"
grep -q 'F1-C2-C3-C4 goes over its barrier, and stays there' fluoro/path-F1-C2-C3-C4.txt || fail "no way over the barrier"
