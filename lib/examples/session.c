/* The C interface: surveys the tables that `wellgyro convert RUN.lcm tool.csv` writes, prints every
 * station as it comes and the verdict: session JOB.toml tool.csv tool.depth.csv */
#include <inttypes.h>
#include <stdio.h>

#include "wellgyro.h"

int main(int argc, char** argv) {
  wellgyro_session* session = NULL;
  wellgyro_imu imu = {.period_ns = 100000000}; /* 10 Hz */
  wellgyro_depth mark = {.sigma_m = -1};
  wellgyro_station s;
  FILE* samples = argc == 4 ? fopen(argv[2], "r") : NULL;
  FILE* marks = argc == 4 ? fopen(argv[3], "r") : NULL;
  int32_t verdict = WELLGYRO_VERDICT_FAIL;
  size_t count;
  int answer;
  if (!samples || !marks) return fputs("session JOB.toml tool.csv tool.depth.csv\n", stderr), 1;
  answer = wellgyro_open(argv[1], &session);
  if (fscanf(marks, "%*[^\n]") == EOF || fscanf(samples, "%*[^\n]") == EOF) answer = 2;
  for (; !answer && fscanf(marks, "%" SCNd64 ",%lf%*[^\n]", &mark.utime_us, &mark.md_m) == 2;
       ++mark.seq)
    answer = wellgyro_push_depth(session, &mark, 1);
  for (; !answer &&
         fscanf(samples, "%" SCNd64 ",%" SCNd64 ",%lf,%lf,%lf,%lf,%lf%*[^\n]", &imu.tool_ns,
                &imu.utime_us, &imu.rate_rad_per_s[0], &imu.rate_rad_per_s[1], &imu.force_mps2[0],
                &imu.force_mps2[1], &imu.force_mps2[2]) == 7;
       ++imu.seq) {
    answer = wellgyro_push_imu(session, &imu, 1);
    while (wellgyro_poll(session, &s, 1, &count) == WELLGYRO_OK && count == 1)
      printf("MD %.1f m, azimuth %.4f rad, revision %d\n", s.md_m, s.azimuth_true_rad, s.revision);
  }
  if (!answer) answer = wellgyro_finish(session);
  if (!answer) answer = wellgyro_verdict(session, 0, &verdict, NULL, 0, NULL);
  if (answer) fprintf(stderr, "%s\n", wellgyro_error(session));
  if (!answer) printf("verdict %d, 0 is pass\n", (int)verdict);
  wellgyro_close(session);
  return answer;
}
