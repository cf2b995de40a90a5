# A signal ends the loop: exit 128 + n, the log so far complete, nothing temporary left.
source "$(dirname "$0")/../lib.sh"
seed "$ball" --set grid.spacing=0.1 --set 'grid.counts=[20,10,10]' | expand --complete -o grid
for i in {1..500}; do echo "0.0$i 0 0"; done >path # 500 s at 1 Hz

for signal in HUP:129 INT:130 TERM:143; do
  # A shell starts background commands with SIGINT ignored; env undoes that.
  env --default-signal=INT,HUP,TERM play grid --device path:path --rate 1 --log log >stdout 2>stderr &
  wait_for 60 "loop" grep -q ' Hz; ' stderr # until then its handlers may not be there
  kill "-${signal%:*}" $!
  code=0
  wait $! || code=$?
  [ "$code" = "${signal#*:}" ] || fail "$signal: exit $code: $(cat stderr)"
  grep -q '^play: [0-9]* ticks, ' stderr || fail "$signal: $(cat stderr)"
  ticks=$(sed -n 's/^play: \([0-9]*\) ticks, .*/\1/p' stderr)
  awk -F '\t' -v ticks="$ticks" 'NF != 21 { bad = 1 } END { exit bad || NR != ticks + 1 }' log ||
    fail "$signal: log of $ticks ticks: $(cat log)"
  rm log stderr
done

# Nobody waits at the end: for a model beside the grid that hangs, nor for a pipe that takes no more messages.
mkdir hangs
cat >hangs.c <<'C'
#include <dlfcn.h>
#include <stdlib.h>
#include <unistd.h>

#include "libcore/model/plugin.h"

static hapgrid_model_table table;
static int (*convert)(hapgrid_model*, const double*, const double*, const double*, double*, char*, size_t);

static int hang(hapgrid_model* m, const double* s, const double* x, const double* d, double* r, char* error, size_t size) {
  while (access("hang", F_OK) == 0) usleep(1000);
  return convert(m, s, x, d, r, error, size);
}

const hapgrid_model_table* hapgrid_model_plugin(void) {
  void* ball = dlopen(getenv("BALL"), RTLD_NOW);
  table = *((const hapgrid_model_table* (*)(void))dlsym(ball, "hapgrid_model_plugin"))();
  convert = table.convert;
  table.convert = hang;
  return &table;
}
C
cc -shared -fPIC -I "$HAPGRID_SOURCE" hangs.c -o hangs/hung-ball.so
export BALL=$HAPGRID_BUILD/models/hung-ball.so
mkfifo hand full
# ends WHAT: play must end by itself within 4 s of SIGTERM.
ends() {
  for ((tick = 0; tick < 30; ++tick)); do echo "0.0$((10 + tick)) 0 0" >&3 && sleep 0.01; done
  kill $!
  timeout 4 tail --pid=$! -f /dev/null || fail "$1 keeps play"
  code=0
  wait $! || code=$?
  same "$1: exit code" 143 $code
}
touch hang
play grid --device path:hand --rate 100 --model-path hangs --log a.session 2>stderr &
exec 3>hand
wait_for 60 "loop" grep -q ' Hz; ' stderr
ends "a model that hangs"
grep -q '^play: the model beside the grid hangs: play ends without it$' stderr || fail "$(cat stderr)"
grep -q '^play: [0-9]* ticks, ' stderr || fail "$(cat stderr)"
stats --log a.session >/dev/null
rm hang
exec 4<>full
play grid --device path:hand --rate 100 --log b.session 2>full &
exec 3>hand
wait_for 60 "loop" test -e b.session
dd if=/dev/zero bs=1 count=65536 oflag=nonblock status=none >&4 2>/dev/null || true
ends "a full pipe"
exec 3>&- 4>&-
rm -r hand full hangs hangs.c ./*.session stderr

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
