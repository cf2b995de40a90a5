/* The cheapest model process: it answers each conversion with the text of the state from which it
 * starts. For tests/bench/process.cpp. Do not copy it, since it relies on how hapgrid writes its
 * lines; examples/hung-ball/hung_ball.py is a model to copy.
 *
 *   echo N        states of N numbers
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int main(int argc, char** argv) {
  static char line[1 << 20];
  if (argc != 2 || !fgets(line, sizeof line, stdin)) return 2;
  printf("{\"hapgrid\": 1, \"state_size\": %s, \"d_max\": 1e9, \"tolerance\": 1e-6}\n", argv[1]);
  fflush(stdout);
  while (fgets(line, sizeof line, stdin)) {
    const long id = strtol(line + strlen("{\"id\": "), NULL, 10);
    const char* s = strchr(line, '[');
    const char* end = s ? strchr(s, ']') : NULL;
    if (!end) return 3;
    printf("{\"id\": %ld, \"s\": %.*s}\n", id, (int)(end + 1 - s), s);
    fflush(stdout);
  }
  return 0;
}
