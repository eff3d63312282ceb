/* Surveys a stream that feed wrote, by the C interface, and prints survey.csv: session JOB STREAM
 */
#include <stdio.h>
#include <stdlib.h>
#include <wellgyro.h>

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
    }
    if (answer != WELLGYRO_OK) return answer;
  }
  return wellgyro_finish(session);
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
  if (answer != WELLGYRO_OK) fprintf(stderr, "%s\n", wellgyro_error(session));
  wellgyro_close(session);
  fclose(stream);
  return answer;
}
