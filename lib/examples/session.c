/* The C interface: what a job file says of itself, and the answer to a survey without samples. */
#include <stdio.h>

#include "wellgyro.h"

int main(int argc, char** argv) {
  wellgyro_session* session = NULL;
  wellgyro_depth mark = {0};
  int answer;
  if (argc != 2) return fputs("usage: session JOB.toml\n", stderr), 1;
  answer = wellgyro_open(argv[1], &session);
  if (answer != WELLGYRO_OK) return fprintf(stderr, "%s\n", wellgyro_error(NULL)), answer;
  mark.utime_us = 1767225600000000;
  mark.md_m = 100;
  mark.sigma_m = -1;
  if (wellgyro_push_depth(session, &mark, 1) != WELLGYRO_OK) puts(wellgyro_error(session));
  if (wellgyro_finish(session) == WELLGYRO_UNUSABLE) {
    printf("wellgyro %s: %s\n", wellgyro_version(), wellgyro_error(session));
  }
  wellgyro_close(session);
  return 0;
}
