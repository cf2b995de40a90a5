# What plot refuses: one line, the right exit code, and no picture; an old one stays as it was.
source "$(dirname "$0")/../lib.sh"
python3=/usr/bin/python3
needs_python matplotlib python3-matplotlib

see='\(see plot --help\)'
wrong() { # REGEX WORDS...
  expect 2 '' "~plot: $1 $see" -- plot "${@:2}"
}
printf '# t\tx\ty\tz\tforce_x\tforce_y\tforce_z\tsent_x\tsent_y\tsent_z\tl0\tl1\tl2\tl3\tl4\tl5\tl6\tl7\ts0\tsnap\n' >log
printf '%d\t%d\t0\t0\t1\t0\t0\t1\t0\t0\t0\t0\t0\t0\t0\t0\t0\t0\t%d\t%d\n' 0 -1 0 0 1 0 1 0 2 1 5 1 3 -1 2 0 >>log
wrong 'the following arguments are required: picture, FILE'
wrong "argument picture: invalid choice: 'pie'.*" pie log -o a.png
wrong 'the following arguments are required: FILE' slice -o a.png
wrong '-o FILE is missing' session log
wrong '-o: a\.jpeg: the name of a picture ends with \.png, \.svg, \.pdf' session log -o a.jpeg
wrong 'columns needs --y COLUMN' columns log -o a.png
wrong '--at is not for session' session log --at y=0 -o a.png
wrong '--allow-process needs --grid, in which a session is replayed' columns log --y s0 --allow-process x -o a.png
wrong 'session draws one file, not 2' session log log -o a.png
nothing_left . log

seed "$ball" -o seeds
expand --complete seeds -o grid
refuses 'plot: grid: a grid, not a session, log or file of frames' -- plot session grid --grid grid -o a.png
mkdir empty
for plane in w=0 z z= z=up z=nan z=0,5 =0; do
  refuses "plot: a plane is like y=0\.25, not '$plane'" -- plot slice grid --at "$plane" -o empty/a.png
done
refuses 'plot: the plane z=0\.6 is outside the box: z goes from -0\.475 to 0\.475' -- plot slice grid --at z=0.6 -o empty/a.png
refuses 'plot: none: No such file or directory' -- plot slice none -o empty/a.png
refuses 'plot: none: No such file or directory' -- plot columns none --y x -o empty/a.png
refuses 'plot: log: .*' -- plot slice log -o empty/a.png
refuses 'plot: grid: a grid, not a session, log or file of frames' -- plot session grid -o empty/a.png
refuses 'plot: log: no column s1: there are t, x, .*, s0, snap' -- plot columns log --y s1 -o empty/a.png
sed '2s/\t/\tup/' log >word
refuses 'plot: word: not a log of play: .*' -- plot columns word --y s0 -o empty/a.png
head -n 1 log >none
refuses 'plot: none: no tick in it' -- plot columns none --y s0 -o empty/a.png
head -c 2000 grid >cut
refuses 'plot: cut: .*' -- plot slice cut -o empty/a.png
refuses 'plot: log/a\.png: Not a directory' -- plot columns log --y s0 -o log/a.png

nothing_left empty

# Without matplotlib, as in a system where it is not installed.
mkdir -p other/bin hidden
ln -s "$HAPGRID_BIN/../python" other/python
sed 's/" -E /" /' "$(command -v plot)" >other/bin/plot
chmod +x other/bin/plot
echo 'raise ImportError("No module named matplotlib")' >hidden/matplotlib.py
echo old >old.png
PYTHONPATH=$PWD/hidden refuses 'plot: No module named matplotlib: install the Debian package python3-matplotlib, or pip install .hapgrid.plot..' -- \
  other/bin/plot columns log --y s0 -o old.png
rm -r hidden
mkdir hidden
echo 'raise ModuleNotFoundError("No module named numpy")' >hidden/numpy.py
PYTHONPATH=$PWD/hidden refuses 'plot: No module named numpy: install the Debian package python3-matplotlib, or pip install .hapgrid.plot..' -- \
  other/bin/plot columns log --y s0 -o old.png
# Modules of another Python, to which PYTHONPATH leads, are left alone.
PYTHONPATH=$PWD/hidden expect 0 '' '' -- plot columns log --y s0 -o a.png
same 'the old picture' old "$(cat old.png)"

# Texts from outside are no formulas, and no lines of their own.
for name in '$\frac{' $'$x$\e[31m'; do
  cp log "$name"
  expect 0 '' '' -- plot columns "$name" log --x x --y s0 -o a.svg
done
