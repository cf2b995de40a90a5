# Every mistake in a MODEL.toml gets one line that says where, exit code 1, and no grid.
source "$(dirname "$0")/../cli/lib.sh"

cat >good.toml <<'END'
[model]
plugin = "hung-ball"
[model.parameters]
radius = 0.1
[grid]
origin = [-0.5, -0.5, -0.5]
spacing = 0.1
counts = [11, 11, 11]
[search]
max_levels = 8
[seeds]
points = [[-0.5, -0.5, -0.5], [0.5, 0.5, 0.5]]
states = [[[0]], [[0.0]]]
END
expect 0 '' '' -- seed good.toml -o good

# bad SED-SCRIPT MESSAGE: the definition with this edit is refused with this message (a regular
# expression behind "seed: bad.toml: "), and by no half of a file.
bad() {
  sed "$1" good.toml >bad.toml
  cmp -s good.toml bad.toml && fail "no edit: $1"
  refuses "seed: bad\.toml: ($2)" -- seed bad.toml -o out
  refuses "seed: standard input: ($2)" -- seed - -o out <bad.toml
  [[ ! -e out ]] || fail "a grid from $1"
}

# Missing keys and tables: the line of the table they are missing from.
bad 2d 'line 1: the key model\.plugin is missing'
bad 6d 'line 5: the key grid\.origin is missing'
bad 7d 'line 5: the key grid\.spacing is missing'
bad 8d 'line 5: the key grid\.counts is missing'
bad 12d 'line 11: the key seeds\.points is missing'
bad '5,8d' 'the table \[grid\] is missing'
bad '1,4d' 'the table \[model\] is missing'
bad 1,20d 'the table \[model\] is missing'

# Files whose contents are parameters.
printf '\0' >zeros
head -c 33600000 /dev/zero | tr '\0' x >big
bad '4a [model.files]\nradius = "big"' 'line 6: radius is both in \[model.parameters\] and in \[model.files\]'
sed '4a [model.files]\nnotes = "gone"' good.toml >bad.toml
refuses 'seed: gone: No such file or directory' -- seed bad.toml -o out
bad '4a [model.files]\nnotes = "zeros"' 'line 6: model\.files\.notes: is no text file'
bad '4a [model.files]\nnotes = ["big", "big"]' 'line 6: the files of \[model\.files\] have more than 67108864 bytes in all'
bad '4a [model.files]\nnotes = 3' 'line 6: model\.files\.notes must be a text in quotes'
# What has no end, or waits for one: refused at once, and the temporary directory stays empty.
mkfifo pipe
ln -s pipe way
for name in /dev/zero pipe way /dev/stdin -; do
  sed "4a [model.files]\nnotes = \"$name\"" good.toml >bad.toml
  why='is no regular file'
  [[ $name != - ]] || why='No such file or directory'
  refuses "seed: $name: $why" -- timeout 10 seed bad.toml -o out < <(sleep 10 2>/dev/null)
done
for name in /dev/zero pipe way; do
  refuses "seed: $name: is no regular file" -- timeout 10 seed $name -o out
done
refuses 'seed: standard input: more than 16777216 bytes, which is the limit' -- seed - -o out </dev/zero
rm zeros big pipe way

# Unknown ones.
bad '7a colour = 1' 'line 8: unknown key grid\.colour \(known: origin, spacing, counts\)'
bad '2a type = 1' 'line 3: unknown key model\.type \(known: plugin, process, name, timeout, parameters, files\)'
bad '10a levels = 1' 'line 11: unknown key search\.levels \(known: max_levels, store\)'
bad '13a colour = 1' 'line 14: unknown key seeds\.colour \(known: points, states\)'
bad '13a [grids]' 'line 14: unknown key grids \(known: model, grid, search, seeds, play\)'
bad '1i x = 1' 'line 1: unknown key x \(known: .*'

# Ill-typed ones, or out of range.
bad 's/"hung-ball"/7/' 'line 2: model\.plugin must be a text in quotes'
bad '3,4c parameters = 3' 'line 3: (model\.)?parameters must be a table'
bad '4a when = 1979-05-27' 'line 5: model\.parameters\.when must be a number, a text, true or false, or an array of numbers or texts'
bad '4a list = [1, "a"]' 'line 5: model\.parameters\.list must be a number'
bad '4a list = ["a", 1]' 'line 5: model\.parameters\.list must be a text in quotes'
bad '4a list = [[1]]' 'line 5: model\.parameters\.list must be a number'
bad '4a big = 9007199254740993' 'line 5: model\.parameters\.big is beyond 2\^53'
bad 's/^origin.*/origin = 0/' 'line 6: grid\.origin must be an array'
bad 's/^origin.*/origin = [0, 0]/' 'line 6: grid\.origin has three entries'
bad 's/^origin.*/origin = [0, 0, 0, 0]/' 'line 6: grid\.origin has three entries'
bad 's/^origin.*/origin = [0, "0", 0]/' 'line 6: grid\.origin must be a number'
bad 's/^origin.*/origin = [0, nan, 0]/' 'line 6: grid\.origin is not finite'
bad 's/^origin.*/origin = [0, 0, -inf]/' 'line 6: grid\.origin is not finite'
bad 's/^spacing.*/spacing = true/' 'line 7: grid\.spacing must be a number'
bad 's/^spacing.*/spacing = inf/' 'line 7: grid\.spacing is not finite'
bad 's/^spacing.*/spacing = 0/' 'line [57]: box: spacing is 0.*, it must be positive'
bad 's/^spacing.*/spacing = -0.1/' 'line [57]: box: spacing is -0\.1.*, it must be positive'
bad 's/^counts.*/counts = [11, 11]/' 'line 8: grid\.counts has three entries'
bad 's/^counts.*/counts = [11, 11, 1.5]/' 'line 8: grid\.counts must be a whole number from 1 to 4294967295'
bad 's/^counts.*/counts = [0, 11, 11]/' 'line 8: grid\.counts must be a whole number from 1 to 4294967295, not 0'
bad 's/^counts.*/counts = [-1, 11, 11]/' 'line 8: grid\.counts must be .*, not -1'
bad 's/^counts.*/counts = [4294967296, 1, 1]/' 'line 8: grid\.counts must be .*, not 4294967296'
bad 's/^counts.*/counts = [65536, 65536, 1]/' 'line [58]: box: more than 4294967295 grid points'
bad 's/^counts.*/counts = [4294967295, 4294967295, 4294967295]/' 'line [58]: box: more than .* grid points'
for limit in 0 -1 255 1.5 '"8"' 99999999999; do
  bad "s/^max_levels.*/max_levels = $limit/" 'line 10: search\.max_levels must be a whole number from 1 to 254.*'
done
bad 's/^points.*/points = []/' 'line 12: seeds\.points is empty'
bad 's/^points.*/points = [1, 2, 3]/' 'line 12: seeds\.points must be an array'
bad 's/^points.*/points = [[0, 0], [0, 0, 0]]/' 'line 12: seeds\.points has three entries'
bad 's/^states.*/states = [[[0]]]/' 'line 13: seeds\.states has 1 entries for 2 points'
bad 's/^states.*/states = [[[0]], []]/' 'line 13: seeds\.states has a point without a state'
bad 's/^states.*/states = [[0], [[0]]]/' 'line 13: seeds\.states must be an array'
bad 's/^states.*/states = [[[0]], [[nan]]]/' 'line 13: seeds\.states is not finite'
bad 's/^states.*/states = [[[-inf]], [[0]]]/' 'line 13: seeds\.states is not finite'
bad 's/^states.*/states = [[["a"]], [[0]]]/' 'line 13: seeds\.states must be a number'

# What is no TOML at all.
bad '7s/$/ 1/' 'line 7: .+'
bad '6s/]//' 'line [67]: .+'
bad '2s/"$//' 'line [23]: .+'
bad '8a spacing = 0.1' 'line 9: .+'
bad '8a [model]' 'line 9: .+'
bad '1s/.*/[model/' 'line [12]: .+'
printf '[model]\nplugin = "\xff\xfe"\n' >bad.toml
refuses 'seed: bad\.toml: line 2: .+' -- seed bad.toml -o out
head -c 20000 /dev/urandom | tr -d '\0' >bad.toml
refuses 'seed: bad\.toml: line [0-9]+: .+' -- seed bad.toml -o out
: >bad.toml
refuses 'seed: bad\.toml: the table \[model\] is missing' -- seed bad.toml -o out
head -c 17000000 /dev/zero | tr '\0' '#' >bad.toml
refuses 'seed: bad\.toml: 17000000 bytes, the limit is 16777216' -- seed bad.toml -o out
# A thousand brackets must not end in a stack that is too small.
python3 -c 'print("x = " + "[" * 200000)' >bad.toml
refuses 'seed: bad\.toml: line 1: .+' -- seed bad.toml -o out
python3 -c 'print("x" + ".x" * 200000 + " = 1")' >bad.toml
refuses 'seed: bad\.toml: .+' -- seed bad.toml -o out

# What the box, the model and the seeds say to each other: with values and limits.
refused() { refuses "seed: $1" -- seed good.toml -o out "${@:2}"; }
# d_max = 2 sqrt(0.11) - 0.2 = 0.46332...; sqrt(3) 0.3 = 0.51961...; 0.46332 / sqrt(3) = 0.26750...
refused 'grid\.spacing 0\.3 is too coarse: a step along the diagonal is 0\.51961[0-9]*, and the model.s conversion is defined up to d_max = 0\.46332[0-9]*; a spacing of at most 0\.26750[0-9]* works' \
  --set grid.spacing=0.3
refused 'grid\.spacing 0\.1 is too coarse: .*' --set model.parameters.radius=0.005
refused 'seed \(-0\.6, 0, 0\): outside the box, which spans \(-0\.5, -0\.5, -0\.5\) to \(0\.5, 0\.5, 0\.5\)' \
  --set 'seeds.points=[[-0.5,-0.5,-0.5],[-0.6,0,0]]'
refused 'seed \(0, 0, 0\.6\): outside the box.*' --set 'seeds.points=[[0,0,0.6],[0.5,0.5,0.5]]'
refused 'seed \(1e\+300, 0, 0\): outside the box.*' --set 'seeds.points=[[1e300,0,0],[0.5,0.5,0.5]]'
refused 'seed \(0\.45, 0, 0\): not a grid point' --set 'seeds.points=[[0.45,0,0],[0.5,0.5,0.5]]'
refused 'seed \(0\.5, 0, 0\): given twice' --set 'seeds.points=[[0.5,0,0],[0.5,0,0]]'
refused 'seed \(0\.5, 0\.5, 0\.5\): a state of 2 components, the model.s have 1' --set 'seeds.states=[[[0]],[[0,0]]]'
refused 'seed \(0\.5, 0\.5, 0\.5\): a state of 0 components, the model.s have 1' --set 'seeds.states=[[[0]],[[]]]'
refused 'seed point 1330 \(10, 10, 10\): states 0 and 2 are equal within the tolerance 1e-06' \
  --set 'seeds.states=[[[0]],[[1],[2],[1.0000001]]]'
refused 'seed point 1330 \(10, 10, 10\): 3 states, the level limit is 2 \(search\.max_levels\)' \
  --set 'seeds.states=[[[0]],[[1],[2],[3]]]' --set search.max_levels=2
# nan and inf from outside the file.
for number in nan inf -inf; do
  refused 'good\.toml: (line 1: )?seeds\.points is not finite' --set "seeds.points=[[$number,0,0],[0.5,0.5,0.5]]"
  refused 'good\.toml: (line 1: )?seeds\.states is not finite' --set "seeds.states=[[[0]],[[$number]]]"
done
# The ball would overlap the HIP: the model knows no state there.
sed 11,13d good.toml >corners.toml
refuses 'seed: seed point 0 \(0, 0, 0\) at \(0, 0, 0\): the model knows no state there; .*' -- \
  seed corners.toml -o out --set 'grid.origin=[0,0,0]' --set 'grid.counts=[3,3,3]'
refuses 'seed: model hung-ball: parameter radius is -1, it must be above 0 and below 0\.5' -- \
  seed good.toml -o out --set model.parameters.radius=-1
refuses 'seed: model hung-ball: unknown parameter radios \(known: .*radius.*\)' -- \
  seed good.toml -o out --set model.parameters.radios=1
refuses 'seed: model hung-ball: parameter radius must be a number' -- \
  seed good.toml -o out --set model.parameters.radius=wide
[[ ! -e out ]] || fail "half a file"

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
