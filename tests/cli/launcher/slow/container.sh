#!/bin/bash
# What the Dockerfile and the definition for Apptainer do, line by line, in fresh roots of Debian 12: podman and apptainer
# need more of a kernel than a test has. The image that comes of it plays a grid and has what `hapgrid molecule` needs.
source "$(dirname "$0")/../../lib.sh"
command -v mmdebstrap >/dev/null || skip "no mmdebstrap: .ci/packages slow installs it"
[[ $(id -u) == 0 ]] || skip "chroot needs root"
package=$HAPGRID_SOURCE/tools/package
python3 "$here/../container.py" "$package/Dockerfile" >stages
python3 "$here/../container.py" "$package/hapgrid.def" >others
python3 - <<'PYTHON'
import json
stages, others = json.load(open("stages")), json.load(open("others"))
assert [stage["run"] for stage in stages] == [stage["run"] for stage in others]
for n, stage in enumerate(stages):
    open(f"run.{n}", "w").write("\n".join(["set -ex", *stage["run"], ""]))
PYTHON
mkdir checkout
git -C "$HAPGRID_SOURCE" ls-files -z | tar -C "$HAPGRID_SOURCE" --null -T - -cf - | tar -C checkout -xf -

# stage NUMBER COPIED DESTINATION: the root NUMBER, with a copy, and its commands run in it.
stage() {
  mmdebstrap --quiet --mode=root --variant=minbase --skip=cleanup/apt/lists bookworm "root.$1" >"log.$1" 2>&1 ||
    fail "$(tail -n 20 "log.$1")"
  cp -a "$2" "root.$1$3"
  cp "run.$1" "root.$1/steps"
  chroot "root.$1" env -i PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin sh /steps >>"log.$1" 2>&1 ||
    fail "$(tail -n 40 "log.$1")"
}
stage 0 checkout /hapgrid
stage 1 root.0/hapgrid.deb /hapgrid.deb
inside() { chroot root.1 env -i PATH=/usr/local/bin:/usr/bin:/bin LC_ALL=C.UTF-8 "$@"; }
ball=/usr/share/doc/hapgrid/examples/hung-ball
inside sh -c "hapgrid seed $ball/hung-ball.toml --set grid.spacing=0.1 --set 'grid.counts=[20,10,10]' |
  hapgrid expand --complete -o /tmp/grid"
expect 0 '' '~verify: fine: .*' -- inside hapgrid verify /tmp/grid -o /tmp/report
inside hapgrid molecule --smiles C#N -o /tmp/cyanide --method gfnff --spacing 1.2 --quiet >line 2>said || fail "$(cat said)"
grep -q '^hapgrid play ' line || fail "$(cat line)"
[[ ! -e root.1/hapgrid.deb ]] || fail 'the package is left in the image'
