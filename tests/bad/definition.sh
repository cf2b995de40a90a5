# Every mistake in a MODEL.toml gets one line that says where, exit code 1, and no grid.
source "$(dirname "$0")/../cli/lib.sh"

cp "$here/good.toml" .
expect 0 '' '' -- seed good.toml -o good
sed 11,13d good.toml >corners.toml  # where the ball would overlap the HIP
printf '\0' >zeros
head -c 33600000 /dev/zero | tr '\0' x >big
mkfifo pipe  # what waits for an end is refused at once
ln -s pipe way

# A thousand brackets must not end in a stack that is too small. In the table, d_max = 2 sqrt(0.11) - 0.2 = 0.46332...;
# sqrt(3) 0.3 = 0.51961...; 0.46332 / sqrt(3) = 0.26750...
refusals "$here/seed.tsv" 'seed bad.toml -o out'
input() { # SED-SCRIPT
  sed "$1" good.toml >bad.toml
  ! cmp -s good.toml bad.toml || fail "no edit: $1"
}
in='bad\.toml' refusals "$here/definition.tsv" 'seed bad.toml -o out'
in='standard input' refusals "$here/definition.tsv" 'seed - -o out <bad.toml'
rm zeros big pipe way

# The level limit: point, limit and tolerance. The paths of one process and of rounds.
through='--set grid.counts=[40,6,6] --set grid.origin=[-0.975,-0.125,-0.125]'
seed "$ball" $through --set search.max_levels=1 -o limited
limit='level limit: point [0-9]+ \([0-9]+, [0-9]+, [0-9]+\) has 1 levels \(search\.max_levels\), and a state reached from point [0-9]+ \([0-9]+, [0-9]+, [0-9]+\) level 0 equals none of them within the tolerance 1e-06 rad: .*'
refuses "expand: $limit" -- expand --complete limited -o out
cp "$work/got/err" in-one
for ((g = 0; g < 40; ++g)); do
  expand limited -o requests
  merge limited requests -o next 2>err || break
  mv next limited
done
same "message of merge" "merge: $(sed 's/^expand: //' in-one)" "$(cat err)"
refuses "merge: $limit" -- merge limited requests -o out
nothing_left . bad.toml corners.toml err good good.toml in-one limited requests
