/* Surveys a stream that feed wrote, by the C interface, and prints its stations as they come,
 * survey.csv and the verdict: session JOB STREAM
 */
#include <inttypes.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <wellgyro.h>

/* Sizes and places as released in 0.1.0; an array of -1 elements does not compile. */
typedef char imu_size[sizeof(wellgyro_imu) == 120 ? 1 : -1];
typedef char imu_rate[offsetof(wellgyro_imu, rate_rad_per_s) == 48 ? 1 : -1];
typedef char depth_size[sizeof(wellgyro_depth) == 48 ? 1 : -1];
typedef char depth_md[offsetof(wellgyro_depth, md_m) == 24 ? 1 : -1];
typedef char station_size[sizeof(wellgyro_station) == 248 ? 1 : -1];
typedef char station_md[offsetof(wellgyro_station, md_m) == 48 ? 1 : -1];
typedef char station_cov[offsetof(wellgyro_station, cov_position_m2) == 176 ? 1 : -1];
/* Added after 0.1.0. */
typedef char directed_size[sizeof(wellgyro_directed_station) == 344 ? 1 : -1];
typedef char directed_tangent[offsetof(wellgyro_directed_station, tangent) == 248 ? 1 : -1];

static int poll(wellgyro_session* session) {
  wellgyro_directed_station stations[7];
  uint64_t words[sizeof *stations / sizeof(uint64_t)];
  size_t count, i, k;
  int answer;
  do {
    answer = wellgyro_poll_directed(session, stations, 7, &count);
    for (i = 0; i < count; ++i) {
      memcpy(words, &stations[i], sizeof words);
      for (k = 0; k < sizeof words / sizeof *words; ++k) printf("%016" PRIX64 " ", words[k]);
      printf("\n");
    }
  } while (answer == WELLGYRO_OK && count > 0);
  return answer;
}

static int finish(wellgyro_session* session) {
  int answer = wellgyro_adjust(session);
  if (answer == WELLGYRO_OK) answer = wellgyro_finish(session);
  return answer == WELLGYRO_OK ? poll(session) : answer;
}

static int push(wellgyro_session* session, FILE* stream) {
  int32_t kind;
  while (fread(&kind, sizeof kind, 1, stream) == 1) {
    int answer;
    if (kind == 0) {
      wellgyro_imu sample;
      if (fread(&sample, sizeof sample, 1, stream) != 1) return WELLGYRO_UNUSABLE;
      answer = wellgyro_push_imu(session, &sample, 1);
    } else {
      wellgyro_depth mark;
      if (fread(&mark, sizeof mark, 1, stream) != 1) return WELLGYRO_UNUSABLE;
      answer = wellgyro_push_depth(session, &mark, 1);
      if (answer == WELLGYRO_OK) answer = poll(session);
    }
    if (answer != WELLGYRO_OK) return answer;
  }
  if (wellgyro_refused(session) != 0) return WELLGYRO_UNUSABLE;
  return finish(session);
}

static int print(wellgyro_session* session) {
  size_t size = 0;
  char* text;
  int answer = wellgyro_survey_csv(session, 0, NULL, 0, &size);
  if (answer != WELLGYRO_USAGE) return answer;
  text = malloc(size);
  if (!text) return WELLGYRO_INTERNAL;
  answer = wellgyro_survey_csv(session, 0, text, size, &size);
  if (answer == WELLGYRO_OK) fputs(text, stdout);
  free(text);
  return answer;
}

static int judge(wellgyro_session* session) {
  char causes[4096];
  size_t size = 0;
  int32_t verdict = -1;
  int answer = wellgyro_verdict(session, 0, &verdict, causes, sizeof causes, &size);
  if (answer == WELLGYRO_OK) printf("%d %s\n", (int)verdict, causes);
  return answer;
}

int main(int argc, char** argv) {
  wellgyro_session* session = NULL;
  FILE* stream;
  int answer;
  if (argc != 3) return WELLGYRO_USAGE;
  stream = fopen(argv[2], "rb");
  if (!stream) return WELLGYRO_UNUSABLE;
  answer = wellgyro_open(argv[1], &session);
  if (answer == WELLGYRO_OK) answer = push(session, stream);
  if (answer == WELLGYRO_OK) answer = print(session);
  if (answer == WELLGYRO_OK) answer = judge(session);
  if (answer != WELLGYRO_OK) fprintf(stderr, "%s\n", wellgyro_error(session));
  wellgyro_close(session);
  fclose(stream);
  return answer;
}
