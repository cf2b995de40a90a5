# Nobody waits at the end of play: for a model beside the grid that hangs, nor for a pipe that takes no more messages.
source "$(dirname "$0")/../lib.sh"
seed "$ball" --set grid.spacing=0.1 --set 'grid.counts=[20,10,10]' | expand --complete -o grid
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
mkfifo full
play_it() { exec play grid --device "process:python3 $HAPGRID_SOURCE/examples/devices/handle.py" --rate 100 "$@"; }
# ends PID WHAT: play must end by itself within 4 s of SIGTERM.
ends() {
  sleep 1
  kill "$1"
  timeout 4 tail --pid="$1" -f /dev/null || { kill "$1"; fail "$2 keeps play"; }
  code=0
  wait "$1" || code=$?
  same "$2: exit code" 143 $code
}
hanging_model() {
  touch hang
  HAPGRID_MODEL_PATH=hangs play_it --log a.session 2>stderr &
  wait_for 60 "loop" grep -q ' Hz; ' stderr
  ends $! "a model that hangs"
  grep -q '^play: the model beside the grid hangs: play ends without it$' stderr || fail "$(cat stderr)"
  grep -q '^play: [0-9]* ticks\?, ' stderr || fail "$(cat stderr)"
  stats a.session >/dev/null
  rm hang
}
full_pipe() {
  exec 4<>full
  play_it --log b.session 2>full &
  wait_for 60 "loop" test -e b.session
  dd if=/dev/zero bs=1 count=65536 oflag=nonblock status=none >&4 2>/dev/null || true
  ends $! "a full pipe"
  exec 4>&-
}
in_time stderr hanging_model
full_pipe
