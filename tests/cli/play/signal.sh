# A signal ends the loop: exit 128 + n, the log so far complete, nothing temporary left.
source "$(dirname "$0")/../lib.sh"
seed "$ball" --set grid.spacing=0.1 --set 'grid.counts=[20,10,10]' | expand --complete -o grid
for i in {1..500}; do echo "0.0$i 0 0"; done >path # 500 s at 1 Hz

# The handlers are there when all three signals are in SigCgt (bits 0, 1 and 14) of play itself: the
# shell that becomes it catches them too, for its trap.
await_handlers() {
  local program mask
  for _ in {1..500}; do
    program=$(cat "/proc/$1/comm")  # before the mask: afterwards it stays play
    mask=$(sed -n 's/^SigCgt:\t//p' "/proc/$1/status")
    [[ $program == play && $((0x$mask & 0x4003)) == $((0x4003)) ]] && return
    sleep 0.02
  done
  fail "no handlers after 10 s"
}

for signal in HUP:129 INT:130 TERM:143; do
  # A shell starts background commands with SIGINT ignored; env undoes that.
  env --default-signal=INT,HUP,TERM play grid --device path:path --rate 1 --log log >stdout 2>stderr &
  await_handlers $!
  kill "-${signal%:*}" $!
  code=0
  wait $! || code=$?
  [ "$code" = "${signal#*:}" ] || fail "$signal: exit $code: $(cat stderr)"
  grep -q '^play: [0-9]* ticks, ' stderr || fail "$signal: $(cat stderr)"
  ticks=$(sed -n 's/^play: \([0-9]*\) ticks, .*/\1/p' stderr)
  awk -F '\t' -v ticks="$ticks" 'NF != 20 { bad = 1 } END { exit bad || NR != ticks + 1 }' log ||
    fail "$signal: log of $ticks ticks: $(cat log)"
  rm log
done

# One that was ignored from the start stays so (nohup).
printf '0 0 0\n0 0 0\n' >two
(
  trap '' HUP
  play grid --device path:two --rate 2 2>stderr &
  pid=$!
  for _ in {1..20}; do kill -HUP $pid; done
  wait $pid
) || fail "an ignored SIGHUP ended it"
nothing_left . grid path stderr stdout two
