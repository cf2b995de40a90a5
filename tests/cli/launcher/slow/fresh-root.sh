# The Debian package installs in a fresh root of Debian 12 with nothing else in it, works there, and goes again.
source "$(dirname "$0")/../../lib.sh"
needs mmdebstrap mmdebstrap
needs dpkg-shlibdeps dpkg-dev
if [[ $(id -u) == 0 ]]; then mode=root; else mode=unshare; fi
cpack --config "$HAPGRID_BUILD/CPackConfig.cmake" -G DEB -D CPACK_DEBIAN_FILE_NAME=hapgrid.deb -B "$PWD/out" >cpack.log 2>&1 ||
  fail "$(cat cpack.log)"

cat >try.sh <<'TRY'
#!/bin/bash
set -euxo pipefail
export LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive
install() { apt-get install -y -qq --no-install-recommends "$@" >/root/apt.log 2>&1 || { cat /root/apt.log; exit 1; }; }
mkdir /root/try
cd /root/try
install /root/hapgrid.deb
[[ $(hapgrid --version) == 'hapgrid 0.1.0' ]]
for tool in seed expand merge verify stats play view check-model; do
  [[ $(hapgrid "$tool" --version) == "hapgrid $tool 0.1.0" ]]
  [[ -s /usr/share/man/man1/hapgrid-$tool.1 ]]
done
[[ $(command -v expand) == /usr/bin/expand && -z $(command -v seed) ]]

# The hung ball in Python, which has the module hapgrid; package.sh has the plug-in.
ball=/usr/share/doc/hapgrid/examples/hung-ball
hapgrid seed $ball/hung-ball-process.toml --allow-process --set 'grid.counts=[8,4,4]' --set grid.spacing=0.15 -o seeds
hapgrid expand --complete --allow-process $ball/hung-ball-process.toml seeds -o process.grid
hapgrid play process.grid --device path:$ball/path-there-and-back.txt --rate 20000 --log a.session

# What is only recommended is asked for in a line.
status=0
hapgrid molecule --smiles CCCC -o butane 2>said || status=$?
[[ $status == 1 && $(wc -l <said) == 1 && ! -e butane ]]
grep 'install the Debian packages python3-numpy python3-rdkit' said
status=0
hapgrid plot slice process.grid -o levels.png 2>said || status=$?
[[ $status == 1 && $(wc -l <said) == 1 && ! -e levels.png ]]
grep python3-matplotlib said

install python3-numpy python3-rdkit python3-scipy
python3 - <<'PYTHON'
import hapgrid
grid = hapgrid.read("process.grid")
n = len(grid["level"])
assert n >= 128 and grid["state"].shape == (n, 1) and grid["force"].shape == (n, 3), grid
assert len(hapgrid.read("a.session")["ticks"]) > 1000
PYTHON
status=0
hapgrid molecule --smiles CCCC -o butane 2>said || status=$?
[[ $status == 1 && $(wc -l <said) == 1 && ! -e butane ]]
grep 'install the Debian packages libxtb6 python3-matplotlib\|install the Debian packages python3-matplotlib libxtb6' said

apt-get remove -y -qq hapgrid >/dev/null
[[ -z $(find /usr -path '*hapgrid*' ! -name '__pycache__' ! -name '*.pyc') ]]
echo 'all is well'
TRY
mmdebstrap --quiet --mode="$mode" --variant=minbase --customize-hook='copy-in out/hapgrid.deb try.sh /root' \
  --customize-hook='chroot "$1" bash /root/try.sh' bookworm /dev/null >log 2>&1 || fail "$(tail -n 40 log)"
grep -qx 'all is well' log || fail "$(cat log)"
