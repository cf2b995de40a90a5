/* disturb WHAT PID...: sends processes a signal: KILL, TERM, SEGV or STOP; or, if WHAT is a number,
 * stops them for so many milliseconds. Prints CLOCK_MONOTONIC in microseconds before. */
#include <signal.h>

#include "tests/qemu/device.h"

static void send(int signal_number, int argc, char** argv) {
  for (int i = 2; i < argc; ++i) kill(atoi(argv[i]), signal_number);
}

int main(int argc, char** argv) {
  if (argc < 3) return 2;
  const char* const what = argv[1];
  const int pause_ms = atoi(what);
  printf("disturbed %lld\n", (long long)(now_ns() / 1000));
  fflush(stdout);
  send(strcmp(what, "KILL") == 0   ? SIGKILL
       : strcmp(what, "TERM") == 0 ? SIGTERM
       : strcmp(what, "SEGV") == 0 ? SIGSEGV
                                   : SIGSTOP,
       argc, argv);
  if (pause_ms == 0) return 0;
  const struct timespec pause = {pause_ms / 1000, pause_ms % 1000 * 1000000L};
  nanosleep(&pause, NULL);
  send(SIGCONT, argc, argv);
  return 0;
}
