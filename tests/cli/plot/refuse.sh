# What plot refuses: one line, the right exit code, and no picture; an old one stays as it was.
source "$(dirname "$0")/../lib.sh"
needs_python matplotlib python3-matplotlib

printf '# t\tx\ty\tz\tforce_x\tforce_y\tforce_z\tsent_x\tsent_y\tsent_z\tl0\tl1\tl2\tl3\tl4\tl5\tl6\tl7\ts0\tsnap\n' >log
printf '%d\t%d\t0\t0\t1\t0\t0\t1\t0\t0\t0\t0\t0\t0\t0\t0\t0\t0\t%d\t%d\n' 0 -1 0 0 1 0 1 0 2 1 5 1 3 -1 2 0 >>log
seed "$ball" | expand --complete -o grid
echo old >old.png
# A copy of plot that heeds PYTHONPATH.
mkdir -p other/bin hidden
ln -s "$HAPGRID_BIN/../python" other/python
sed 's/" -E /" /' "$(command -v plot)" >other/bin/plot
chmod +x other/bin/plot
refusals "$here/refuse.tsv"
nothing_left . cut grid hidden log none old.png other word
same 'the old picture' old "$(cat old.png)"
# Modules of another Python, to which PYTHONPATH leads, are left alone.
PYTHONPATH=$PWD/hidden expect 0 '' '' -- plot columns log --y s0 -o a.png

# Texts from outside are no formulas, and no lines of their own.
for name in '$\frac{' $'$x$\e[31m'; do
  cp log "$name"
  expect 0 '' '' -- plot columns "$name" log --x x --y s0 -o a.svg
done
