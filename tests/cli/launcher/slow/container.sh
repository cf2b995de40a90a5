# What the Dockerfile does, line by line, in fresh roots of Debian 12: podman needs more of a kernel than a test has. The
# image that comes of it plays a grid and has what `hapgrid molecule` needs.
source "$(dirname "$0")/../../lib.sh"
needs mmdebstrap mmdebstrap
[[ $(id -u) == 0 ]] || skip "chroot needs root"
unset CMAKE_C_COMPILER_LAUNCHER CMAKE_CXX_COMPILER_LAUNCHER  # of this machine: the roots have none
package=$HAPGRID_SOURCE/tools/package
python3 - "$package/Dockerfile" <<'PYTHON'
import re
import sys
# The RUN lines of the stage that builds the package, and of the one that installs it.
text = re.sub(r"\\\n\s*", "", open(sys.argv[1]).read())
_, *stages = re.split(r"^FROM ", text, flags=re.M)
assert len(stages) == 2, stages
for n, stage in enumerate(stages):
    run = re.findall(r"^RUN (.*)", stage, re.M)
    assert run, stage
    open(f"run.{n}", "w").write("\n".join(["set -ex", *run, ""]))
PYTHON
mkdir hapgrid
git -C "$HAPGRID_SOURCE" ls-files -z | tar -C "$HAPGRID_SOURCE" --null -T - -cf - | tar -C hapgrid -xf -
cat >try.sh <<'TRY'
set -euxo pipefail
export LC_ALL=C.UTF-8
unset HAPGRID_BIN HAPGRID_MODEL_PATH  # of the machine outside
cd /root
[[ ! -e /hapgrid.deb ]]
hapgrid seed /usr/share/doc/hapgrid/examples/hung-ball/hung-ball.toml |
  hapgrid expand --complete -o grid
hapgrid verify grid -o report
hapgrid molecule --smiles C#N -o cyanide --method gfnff --spacing 1.2 --quiet | grep '^hapgrid feel '
echo 'all is well'
TRY

# stage NUMBER COPIED HOOK...: a root with what is copied, in which the stage's commands are run.
stage() {
  mmdebstrap --quiet --mode=root --variant=minbase --customize-hook="copy-in $2 run.$1 /" \
    --customize-hook="chroot \"\$1\" sh /run.$1" "${@:3}" bookworm /dev/null >"log.$1" 2>&1 || fail "$(tail -n 40 "log.$1")"
}
stage 0 hapgrid --customize-hook='copy-out /hapgrid.deb .'
stage 1 'hapgrid.deb try.sh' --customize-hook='chroot "$1" bash /try.sh'
grep -qx 'all is well' log.1 || fail "$(tail -n 40 log.1)"
