# view --web: pages in a browser without a screen watch a play, and see when it snaps and ends; strangers are refused, and
# nobody can move the hand.
source "$(dirname "$0")/../lib.sh"
export ASAN_OPTIONS=detect_leaks=0 VALGRIND_OPTS=--leak-check=no # what libwebsockets keeps at the end is its own
seed "$ball" --set grid.spacing=0.1 --set 'grid.counts=[20,10,10]' | expand --complete -o grid
see='(see view --help)'
for place in here 0.0.0.0 here:80 ::1:80 127.1:80 65536 -1 127.0.0.1: 80:127.0.0.1 ' 80'; do
  for option in --web --imd; do
    expect 2 '' "view: $option: '$place' is not an IPv4 address and a port, like 8888 or 127.0.0.1:8888 $see" \
      -- view frames $option="$place"
  done
done
expect 2 '' "view: --png excludes --web $see" -- view frames --web --png x
echo '0 0 0' >path
play grid --device path:path --frames frames 2>/dev/null
# A port that another one has, and an address that others reach.
served() { # OPTION
  rm -f address
  view frames "$1" >address 2>err &
  first=$!
  wait_for 60 "address" grep -q http address
  port=$(sed -E 's|.*:([0-9]+)/.*|\1|' address)
}
over() { kill $first; wait $first || :; }
served --web
refuses "view: cannot listen on port $port of 127.0.0.1: is another program there\?" -- view frames --web="$port"
over
SSH_CONNECTION='10.0.0.2 5000 10.0.0.1 22' served --web
wait_for 60 "how the page comes over ssh" grep -q 'ssh -L' err
same 'the tunnel' "~view: over ssh: on your own machine, ssh -L $port:127\.0\.0\.1:$port and .*" "$(cat err)"
over
served --web=0.0.0.0:0
over
same 'the address' '~http://.*:[0-9]+/[0-9a-f]{32}/' "$(cat address)"
same 'the warning' "~view: whoever reaches 0\.0\.0\.0 .* can watch; nothing on the way is encrypted" "$(cat err)"

needs chromium chromium
evidence() { cat err; }
# To the left of the ball and through it, again and again, until the browser has seen enough and ends the play.
awk 'BEGIN { for (k = 0; k < 200; ++k) for (i = -70; i <= 90; ++i) for (j = 0; j < 10; ++j) print i / 100, 0.01, 0 }' >path
# attempt: from the beginning, as in_time does it.
attempt() {
  trap 'kill ${play-} ${watched-} 2>/dev/null || :; wait || :' EXIT
  : >err
  rm -f address
  rm -f stream
  mkfifo stream
  view --web <stream >address 2>>err &
  watched=$!
  play grid --device path:path --rate 1000 --frames stream 2>>err &
  play=$!
  wait_for 60 "address" grep -q http address
  mkdir -p browser  # where Chromium leaves what it does not remove
  HOME=$PWD TMPDIR=$PWD/browser /usr/bin/python3 "$here/live.py" "$(cat address)" $play 2>>err || fail "$(cat err)"
  kill $watched
}
in_time err attempt
