# A signal ends the loop: exit 128 + n, log and frames so far complete, nothing temporary left.
source "$(dirname "$0")/../lib.sh"
seed "$ball" --set grid.spacing=0.1 --set 'grid.counts=[20,10,10]' | expand --complete -o grid
for i in {1..500}; do echo "0.0$i 0 0"; done >path # 500 s at 1 Hz

for signal in HUP:129 INT:130 TERM:143; do
  # A shell starts background commands with SIGINT ignored; env undoes that.
  env --default-signal=INT,HUP,TERM play grid --device path:path --rate 1 --log log --frames frames >stdout 2>stderr &
  wait_for 60 "loop" grep -q ' Hz; ' stderr # until then its handlers may not be there
  kill "-${signal%:*}" $!
  code=0
  wait $! || code=$?
  [ "$code" = "${signal#*:}" ] || fail "$signal: exit $code: $(cat stderr)"
  grep -q '^play: [0-9]* ticks\?, ' stderr || fail "$signal: $(cat stderr)"
  ticks=$(sed -n 's/^play: \([0-9]*\) ticks\?, .*/\1/p' stderr)
  awk -F '\t' -v ticks="$ticks" 'NF != 21 { bad = 1 } END { exit bad || NR != ticks + 1 }' log ||
    fail "$signal: log of $ticks ticks: $(cat log)"
  expect 0 '~model .*' '' -- view frames
  rm frames log stderr
done

# One that was ignored from the start stays so (nohup).
printf '0 0 0\n0 0 0\n' >two
(
  trap '' HUP
  play grid --device path:two --rate 5 2>stderr &
  pid=$!
  for _ in {1..20}; do kill -HUP $pid; done
  wait $pid
) || fail "an ignored SIGHUP ended it"
nothing_left . grid path stderr stdout two
