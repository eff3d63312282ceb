/* The C interface: surveys the tables that `wellgyro convert RUN.lcm tool.csv` writes. */
#include <inttypes.h>
#include <stdio.h>

#include "wellgyro.h"

int main(int argc, char** argv) {
  wellgyro_session* session = NULL;
  wellgyro_imu imu = {.period_ns = 100000000}; /* 10 Hz */
  wellgyro_depth mark = {.sigma_m = -1};
  wellgyro_station s;
  int32_t verdict = WELLGYRO_VERDICT_FAIL;
  size_t count;
  double *w = imu.rate_rad_per_s, *f = imu.force_mps2;
  FILE *samples = fopen(argc > 3 ? argv[2] : "", "r"), *marks = fopen(argc > 3 ? argv[3] : "", "r");
  if (!samples || !marks) return perror("session JOB.toml tool.csv tool.depth.csv"), 1;
  if (wellgyro_open(argv[1], &session)) return puts(wellgyro_error(NULL)), 1;
  if (fscanf(marks, "%*[^\n]") == EOF || fscanf(samples, "%*[^\n]") == EOF) return 1;
  for (; fscanf(marks, "%" SCNd64 ",%lf%*[^\n]", &mark.utime_us, &mark.md_m) == 2; ++mark.seq)
    wellgyro_push_depth(session, &mark, 1);
  while (fscanf(samples, "%" SCNd64 ",%" SCNd64 ",%lf,%lf,%lf,%lf,%lf%*[^\n]", &imu.tool_ns,
                &imu.utime_us, w, w + 1, f, f + 1, f + 2) == 7) {
    wellgyro_push_imu(session, &imu, 1), ++imu.seq;
    while (!wellgyro_poll(session, &s, 1, &count) && count == 1)
      printf("MD %.1f m, azimuth %.4f rad, revision %d\n", s.md_m, s.azimuth_true_rad, s.revision);
  }
  if (!wellgyro_finish(session)) wellgyro_verdict(session, 0, &verdict, NULL, 0, NULL);
  printf("verdict %d, 0 is pass; %d refused\n", (int)verdict, (int)wellgyro_refused(session));
  return wellgyro_close(session), verdict;
}
