#!/bin/bash
# A newcomer's first day, on a bare machine: what the README and the guide tell a reader to type, cut out of these pages,
# in a minimal root of Debian that has make and g++, and nothing else.
#
#   tests/fresh.sh SUITE [STEP...]      as root; SUITE is bookworm, trixie ..., or a tar file that mmdebstrap made
#
# The root gets what is committed here. Each step takes up where the one before it ended; by default all are done:
#
#   ball        the demonstration, and the page in which its grid is felt
#   own         a model of one's own in Python
#   languages   and in the languages that have a compiler
#   package     the Debian package is made; in a second root, which has no more than this one had, it is installed and works
#   wheel       .ci/wheel makes the wheel, on Debian 12, and leaves it in dist/
#   pip         in a second root, a user who is not root installs the wheel of dist/ with pip; it comes by itself after `wheel`
#   check       the tests
#   molecule    from a molecule to a grid, which is felt
#   rest        only where it is asked for: the tests that check-all has beyond check, and those that lacked a package there
#   clone       as the last one, since it changes how build/ installs: pip installs from the clone itself, where Debian has
#               scikit-build-core, which is 13 and newer
#   with:CXX    everything compiles with clang++-16, g++-13 ..., without a warning
#   tar:FILE    the bare root as a file, which can stand for SUITE later
#   build       the folder build/ is taken out of the root; the clone has the same path there, so a build here goes on with it
#
# A table comes at the end: seconds, megabytes downloaded and installed from Debian's packages. The output of a step
# that fails is shown, and the others are done all the same. `lacking` says that this release has no package for a step.
set -euo pipefail

# --- Inside the root ------------------------------------------------------------------------------

# commands PAGE HEADING: the lines of the shell that stand under a heading.
# shellcheck disable=SC2016  # no variables are in it
commands() { sed -n "/^##* $2\$/,/^##* [A-Z]/p" "$1" | sed -n 's/^    //p; /^```sh$/,/^```$/{/^```/!p}' | grep .; }

# type_in: runs lines as a reader would. What is felt is felt by felt() below.
type_in() {
  local lines
  lines=$(sed -E 's/^([^ ]*hapgrid feel )/felt \1/')
  echo "$lines"
  eval "$lines"
}

# felt COMMAND...: hapgrid feel; the page that it writes must have the scene, the player and the grid, and the player must ask
# nothing of a system, which a browser has not.
felt() {
  local said page
  said=$("$@" 2>&1) || { echo "$said"; exit 1; }
  page=$(sed -n 's/^hapgrid: feel: open in a browser: \([^ ]*\).*/\1/p' <<<"$said")
  grep -q '^let data = {"model":"' "$page" || { echo "no scene in '$page': $said"; exit 1; }
  sed -n 's/^const packed = {"player":"\([^"]*\)","grid":"\([^"]*\)"};$/\1 \2/p' "$page" | {
    read -r player grid
    ((${#player} > 40000 && ${#grid} > 10000)) || { echo "no player or no grid in '$page'"; exit 1; }
    python3 -c 'import base64, sys, zlib; assert b"wasi_snapshot" not in zlib.decompress(base64.b64decode(sys.stdin.read()))' <<<"$player"
  }
  echo "$page: $(stat -c %s "$page") bytes"
}

do_ball() { commands README.md 'Feel the hung ball' | type_in; }
# Debian's testing is without RDKit now and then: 77 stands for a step that cannot be tried.
do_molecule() {
  apt-get update -qq
  [[ $(apt-cache policy python3-rdkit) == *'Candidate: '[0-9]* ]] || return 77
  commands README.md 'Feel a molecule' | type_in
}
do_own() { commands README.md 'Bring your own model' | type_in; }
do_languages() {
  local lines language
  lines=$(commands README.md 'Bring your own model')
  for language in c c++ fortran; do
    sed "s/--lang python/--lang $language/; s/mymodel/my_${language/++/xx}/" <<<"$lines" | type_in
  done
}
the_package() { commands examples/guide/installing.md Installing | sed -n '/dpkg-dev/,$p'; }
do_package() { the_package | sed '$d' | type_in; }
do_installed() {
  apt-get update -qq
  the_package | sed -n '$p' | type_in
  felt hapgrid feel "$(hapgrid data)/hung-ball.grid"
}
do_wheel() { .ci/wheel; }
# Debian's numpy, matplotlib and jinja2 stand for those that pip would get.
do_pip() {
  apt-get update -qq
  apt-get install -qq --no-install-recommends python3-venv python3-jinja2 python3-matplotlib
  useradd --create-home user
  su user -c "cd && exec bash $PWD/tests/fresh.sh --do user"
}
# Nothing but the wheel, glibc, libstdc++ and libgcc is in use; from `pip install` to the page it takes a minute at most.
do_user() {
  local wheel file name begin
  wheel=$(echo "$PWD"/dist/hapgrid-*-py3-none-manylinux_2_36_x86_64.whl)
  cd ~
  (($(stat -c %s "$wheel") < 15000000)) || { ls -l "$wheel"; exit 1; }
  python3 -m venv --system-site-packages mine
  # shellcheck disable=SC1091  # Python's
  source mine/bin/activate
  begin=$SECONDS
  pip install --no-index "${wheel}[plot]"
  felt hapgrid feel "$(hapgrid data)/hung-ball.grid"
  ((SECONDS - begin < 60)) || { echo "$((SECONDS - begin)) s from pip install to the page"; exit 1; }

  find mine/lib/hapgrid mine/bin/hapgrid -type f | while read -r file; do
    [[ $(head -c 4 "$file" | tail -c 3) == ELF ]] || continue
    ldd "$file" | sed 's/ (0x.*//' | while read -r name _ file; do
      case $name in
        linux-vdso.so.1 | /lib64/ld-linux-x86-64.so.2) ;;
        libc.so.6 | libm.so.6 | libdl.so.2 | libpthread.so.0 | librt.so.1 | libstdc++.so.6 | libgcc_s.so.1) ;;
        statically) ;;
        *) [[ $(realpath "$file") == ~/mine/lib/hapgrid/libs/* ]] || { echo "$name is from outside: $file"; exit 1; } ;;
      esac
    done
  done

  hapgrid init m --lang python
  make -C m
  hapgrid seed "$(hapgrid data)/hung-ball.toml" | hapgrid expand --complete | tee ball.grid | hapgrid verify
  cmp ball.grid "$(hapgrid data)/hung-ball.grid"
  hapgrid plot slice ball.grid --at y=0 -o levels.png
  hapgrid play ball.grid --device "path:$(hapgrid data)/../doc/hapgrid/examples/hung-ball/path-there-and-back.txt" --frames - |
    hapgrid view --png picture.png
  [[ -s levels.png && -s picture.png ]]
  hapgrid help seed
  python -c 'import hapgrid, sys; assert len(hapgrid.read("ball.grid")["state"]) > 2000, sys.path'
  printf '3 2 2\n' >bad.dx
  [[ $(hapgrid table bad.dx -o bad 2>&1) == *'table: bad.dx: no OpenDX table'* ]]  # its parser has libseccomp
  [[ $(hapgrid molecule --smiles C 2>&1) == *"pip install 'hapgrid[molecule]'" ]]
}
# What was built here is taken, not compiled again.
do_clone() {
  apt-get install -qq --no-install-recommends python3-venv python3-scikit-build-core
  python3 -m venv --system-site-packages /clone
  /clone/bin/pip install --no-build-isolation --no-index --no-deps -C build-dir=build .
  (cd / && /clone/bin/python -c 'import hapgrid; print(hapgrid.__file__)' | grep '^/clone/lib/hapgrid/')
  /clone/bin/hapgrid verify "$(/clone/bin/hapgrid data)/hung-ball.grid"
  rm -r /clone
}
# Without CI, for which a test whose program is not installed has failed.
do_check() {
  unset CI
  eval "$(grep -om 1 'make -f Makefile.example check' README.md)"
  sed -nE 's|^[0-9]+/[0-9]+ Test: ||; t name; /^not installed:/!d; G; p; d; :name h; d' build/Testing/Temporary/LastTest.log |
    sed -E 'N; s/(.*)\n(.*)/\2: \1/' | tee /lacked
}
do_with() {
  local release=Debug  # which a clang warns about as much
  [[ $1 != g++-* ]] || release=Release
  .ci/packages demo build check
  apt-get install -qq --no-install-recommends "${1/clang++/clang}"
  cmake --preset check -B /with -D CMAKE_CXX_COMPILER="$1" -D CMAKE_C_COMPILER="$(sed 's/clang++/clang/; s/g++/gcc/' <<<"$1")" \
    -D CMAKE_BUILD_TYPE=$release -D CMAKE_CXX_FLAGS_DEBUG=-O0 -D HAPGRID_WERROR=ON
  cmake --build /with --target all check-all
  rm -r /with
}
do_rest() {
  .ci/packages plots check-all
  cmake --preset check >/dev/null  # make build leaves the tests out
  cmake --build build --target check-all benches
  ctest --preset check-all -L 'extra|long' -j "$((2 * $(nproc)))"
  [[ ! -s /lacked ]] || ctest --preset check-all -R "^($(cut -d: -f1 /lacked | sort -u | paste -sd '|'))\$"
}

packages() { dpkg-query -W -f '${Package}=${Version} ${Installed-Size}\n' | sort; }

# row STEP: does it, and prints its row of the table.
row() {
  local before seconds code=0 result=ok new kilobytes bytes
  before=$(packages) seconds=$SECONDS
  DEBIAN_FRONTEND=noninteractive "$0" --do "$1" >/step.log 2>&1 </dev/null || code=$?
  seconds=$((SECONDS - seconds))
  case $code in 0) ;; 77) result=lacking ;; *) result=FAILED ;; esac
  if [[ $result == ok ]]; then grep -E ': not installed:|tests passed' /step.log >&2 || :; else tail -n 200 /step.log >&2; fi
  new=$(comm -13 <(echo "$before") <(packages))
  kilobytes=$(awk '{ sum += $2 } END { printf "%d", sum }' <<<"$new")
  bytes=$(cut -d' ' -f1 <<<"$new" | { xargs -r apt-cache show 2>/dev/null || :; } | awk '/^Size:/ { sum += $2 } END { printf "%d", sum }')
  printf '%-12s %-8s %7d %9d %9d\n' "$1" $result $seconds $((bytes / 1000000)) $((kilobytes * 1024 / 1000000))
}

case ${1-} in
  --do)
    cd "${0%/tests/fresh.sh}"
    if [[ $2 == with:* ]]; then do_with "${2#with:}"; else "do_$2"; fi
    exit
    ;;
  --inside)
    # apt asks whether it shall, and a reader says yes.
    echo 'APT::Get::Assume-Yes "true";' >/etc/apt/apt.conf.d/90yes
    row "$2"
    exit
    ;;
esac

# --- Outside --------------------------------------------------------------------------------------

suite=${1:?which suite?}
shift
(($#)) || set -- ball own languages package check molecule
source=$(cd "$(dirname "$0")/.." && pwd)
work=$(mktemp -d)
child=
trap '[[ -z $child ]] || kill -KILL "$child" 2>/dev/null || :; wait; rm -rf "$work" || { sleep 1; rm -rf "$work"; }' EXIT
trap 'exit 1' HUP INT TERM

# root NAME: unpacks a bare root with the clone in it.
root() {
  mkdir "$work/$1"
  tar -C "$work/$1" --exclude='./dev/*' -xf "$bare"
  mkdir -p "$work/$1$source"
  chmod a+x "$work/$1/root"  # the clone may be below it, and not only root reads it
  git -C "$source" -c safe.directory="$source" archive HEAD | tar -C "$work/$1$source" -xf -
  echo '127.0.0.1 localhost' >"$work/$1/etc/hosts"
  echo force-unsafe-io >"$work/$1/etc/dpkg/dpkg.cfg.d/unsafe-io"  # it may lose what a power cut would lose
}

# inside NAME COMMAND...: runs a command in this root, with devices as a container has them. All that it starts, and all that
# is mounted for it, goes when it ends or this script does.
inside() {
  # shellcheck disable=SC2016  # for the shell inside
  unshare --mount --pid --fork --kill-child bash -euc '
    root=$1
    mount -t tmpfs -o mode=755 dev "$root/dev"
    for device in null zero full random urandom tty; do
      touch "$root/dev/$device"
      mount --bind "/dev/$device" "$root/dev/$device"
    done
    mkdir "$root/dev/pts" "$root/dev/shm"
    ln -s /proc/self/fd "$root/dev/fd"
    for stream in 0:stdin 1:stdout 2:stderr; do ln -s "/proc/self/fd/${stream%:*}" "$root/dev/${stream#*:}"; done
    mount -t devpts -o newinstance,ptmxmode=0666 devpts "$root/dev/pts"
    mount -t tmpfs shm "$root/dev/shm"
    ln -s pts/ptmx "$root/dev/ptmx"
    mount -t proc proc "$root/proc"
    mount -t sysfs -o ro sys "$root/sys"
    exec chroot "$root" env -i ${CI:+CI="$CI" HAPGRID_WERROR=ON} HOME=/root PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin "${@:2}"' \
    bash "$work/$1" "${@:2}" &
  child=$!
  wait "$child"
  child=
}

bare=$suite
: >"$work/table"
if [[ ! -f $bare ]]; then
  bare=$work/bare.tar
  # A mirror's testing can be weeks old; its signature counts.
  mmdebstrap --quiet --variant=minbase --aptopt='Acquire::Check-Valid-Until "false"' --include=make,g++ "$suite" "$bare"
fi
root day
try_pip() {
  root other
  mkdir "$work/other$source/dist"
  cp "$source"/dist/*.whl "$work/other$source/dist"
  inside other "$source/tests/fresh.sh" --inside pip >>"$work/table"
}
for step; do
  case $step in
    pip)
      try_pip
      continue
      ;;
    tar:*)
      cp "$bare" "${step#tar:}"
      continue
      ;;
    build)
      rm -rf "$source/build"
      mv "$work/day$source/build" "$source"
      continue
      ;;
  esac
  inside day "$source/tests/fresh.sh" --inside "$step" >>"$work/table"
  case $step in
    package)
      root second
      mkdir "$work/second$source/build"
      cp "$work/day$source"/build/hapgrid_*.deb "$work/second$source/build"
      inside second "$source/tests/fresh.sh" --inside installed >>"$work/table"
      ;;
    wheel)
      mkdir -p "$source/dist"
      cp "$work/day$source"/dist/*.whl "$source/dist"
      try_pip
      ;;
  esac
done
printf '%-12s %-8s %7s %9s %9s\n' "$(basename "$suite" .tar)" result seconds 'MB down' 'MB disk'
cat "$work/table"
! grep -q FAILED "$work/table"
