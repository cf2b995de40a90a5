/* disturb WHAT PID...: sends processes a signal: KILL, TERM, SEGV or STOP; or, if WHAT is a number,
 * stops them for so many milliseconds; or, if it is SPIN, makes them compute for ever. Prints
 * CLOCK_MONOTONIC in microseconds before. Its own priority must be above theirs. */
#include <dirent.h>
#include <signal.h>

#include "tests/qemu/device.h"

enum { kMostPlaces = 64, kTickUs = 6000 };
static struct {
  const char* pid;
  long long address;
} places[kMostPlaces];
static int found;

static void nap(long microseconds) {
  const struct timespec pause = {0, microseconds * 1000};
  nanosleep(&pause, NULL);
}

static void send(int signal_number, int argc, char** argv) {
  for (int i = 2; i < argc; ++i) kill(atoi(argv[i]), signal_number);
}

/* Where each thread of a process will come back from the kernel. */
static void find_places(const char* pid) {
  char path[128], text[256];
  snprintf(path, sizeof path, "/proc/%s/task", pid);
  DIR* const tasks = opendir(path);
  for (struct dirent* task; tasks && (task = readdir(tasks)) != NULL;) {
    if (task->d_name[0] == '.' || found == kMostPlaces) continue;
    snprintf(path, sizeof path, "/proc/%s/task/%.20s/syscall", pid, task->d_name);
    for (int tries = 0; tries < 20; ++tries) {
      const int fd = open(path, O_RDONLY);
      const ssize_t size = fd < 0 ? 0 : read(fd, text, sizeof text - 1);
      if (fd >= 0) close(fd);
      text[size > 0 ? size : 0] = '\0';
      const char* const last = strrchr(text, ' ');
      if (last) {
        places[found].pid = pid;
        places[found++].address = strtoll(last, NULL, 16);
        break;
      }
      nap(500); /* "running" */
    }
  }
  if (tasks) closedir(tasks);
}

/* What follows there becomes `jmp .`. */
static void make_spin(const char* pid) {
  char path[64];
  snprintf(path, sizeof path, "/proc/%s/mem", pid);
  const int memory = open(path, O_RDWR);
  for (int i = 0; i < found; ++i)
    if (strcmp(places[i].pid, pid) == 0 && pwrite(memory, "\xeb\xfe", 2, places[i].address) != 2)
      die(path);
  if (memory >= 0) close(memory);
}

/* The last one, an adapter, begins first: then play waits for its answer, at another place. */
static void spin(int argc, char** argv) {
  for (int i = 2; i < argc; ++i) find_places(argv[i]);
  make_spin(argv[argc - 1]);
  if (argc == 3) return;
  nap(kTickUs);
  find_places(argv[2]);
  for (int i = 2; i < argc - 1; ++i) make_spin(argv[i]);
}

int main(int argc, char** argv) {
  if (argc < 3) return 2;
  const char* const what = argv[1];
  const int pause_ms = atoi(what);
  printf("disturbed %lld\n", (long long)(now_ns() / 1000));
  fflush(stdout);
  if (strcmp(what, "SPIN") == 0) {
    spin(argc, argv);
    return 0;
  }
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
