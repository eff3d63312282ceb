#ifndef WELLGYRO_H
#define WELLGYRO_H

/// @file
/// wellgyro for C and for every language that calls C: one session surveys one job.
///
/// Units stand in the names; angles are true, times are integers. Strings are UTF-8. Functions give
/// WELLGYRO_OK or what went wrong, with a sentence in wellgyro_error. No exception leaves, and no
/// call order does harm: what comes too late or too early is refused. A null session, or a null
/// pointer with a count above 0, is WELLGYRO_USAGE.
///
/// Threads: one thread at a time may use a session; different sessions do not know of each other.
///
/// Promise: structs and functions of a released version stay as they are; a change gets a new name.

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/// Marks what the shared library shows.
#if defined(_WIN32)
#define WELLGYRO_C
#else
#define WELLGYRO_C __attribute__((visibility("default")))
#endif

/// One survey: from wellgyro_open to wellgyro_close.
typedef struct wellgyro_session wellgyro_session;

/// What functions give.
enum {
  WELLGYRO_OK = 0,
  WELLGYRO_USAGE = 1,     ///< the call makes no sense, as after wellgyro_finish
  WELLGYRO_UNUSABLE = 2,  ///< a file or a value of it cannot be used, or there is no survey
  WELLGYRO_INTERNAL = 3   ///< memory ran out, or a mistake of the library
};

/// Bits of the flags of a sample.
enum {
  WELLGYRO_HAS_GZ = 1,
  WELLGYRO_HAS_MAG = 2,
  WELLGYRO_GYRO_SATURATED = 4,
  WELLGYRO_ACCEL_SATURATED = 8,
  WELLGYRO_UTC_UNSYNCED = 16
};

/// The mean over the period that begins at tool_ns, in tool axes: z down-hole, x to the reference
/// mark.
typedef struct wellgyro_imu {
  int64_t tool_ns;   ///< the tool's own clock
  int64_t utime_us;  ///< UTC since 1970, as the surface estimates it
  int64_t seq;       ///< counts the samples of a session of the tool
  int32_t session;   ///< changes when the tool restarts
  int32_t run;       ///< from 1; 0: not known
  int32_t tool;
  int32_t period_ns;
  uint32_t flags;
  float temperature_degc;
  double rate_rad_per_s[3];
  double force_mps2[3];  ///< specific force
  double field_t[3];     ///< magnetic flux density [T]; where WELLGYRO_HAS_MAG
} wellgyro_imu;

/// Bits of the quality of a station: why it is worth less than its sigmas say.
enum {
  WELLGYRO_QUALITY_GOOD = 0,
  WELLGYRO_QUALITY_MOVED = 1,         ///< the tool turned or travelled during a stop
  WELLGYRO_QUALITY_MIRROR = 2,        ///< the north fix has a second solution, not excluded
  WELLGYRO_QUALITY_VERTICAL = 4,      ///< too near vertical for azimuth or toolface to mean much
  WELLGYRO_QUALITY_SATURATED = 8,     ///< a sensor reached its full scale
  WELLGYRO_QUALITY_GAP = 16,          ///< samples are missing
  WELLGYRO_QUALITY_DEPTH = 32,        ///< depth missing, held or contradicted
  WELLGYRO_QUALITY_TEMPERATURE = 64,  ///< outside the calibrated temperatures
  WELLGYRO_QUALITY_ALIASED = 128,     ///< rotation too fast for the sampling on the way to it
  WELLGYRO_QUALITY_GRAVITY = 256,     ///< |f| differs from gravity beyond its limit
  WELLGYRO_QUALITY_EARTH_RATE = 512,  ///< the rate at rest differs from the Earth's
  WELLGYRO_QUALITY_CLOCK = 1024,      ///< the tie of the tool's clock to UTC is doubtful
  WELLGYRO_QUALITY_UNFIT = 2048       ///< what failed the run can have touched it: do not use it
};

/// What a survey is worth to those who are handed it.
enum {
  WELLGYRO_VERDICT_PASS = 0,
  WELLGYRO_VERDICT_WARN = 1,
  WELLGYRO_VERDICT_FAIL = 2  ///< whole, but not to be handed over as it is
};

/// A reading of the depth system: along-hole depth of the string's reference point.
typedef struct wellgyro_depth {
  int64_t utime_us;
  int64_t seq;
  int32_t session;
  int32_t run;
  double md_m;
  double sigma_m;    ///< below 0: not known
  int32_t kind;      ///< 0 indicated, 1 wireline, 2 drill pipe, 3 tubing, 4 other; no more
  uint32_t stopped;  ///< 1 while the string is held
} wellgyro_depth;

/// A survey station. Covariances are 1-sigma squared, row by row, three numbers a row. Near
/// vertical the variance of the azimuth means little: the azimuth itself does there.
typedef struct wellgyro_station {
  int64_t utime_us;
  int32_t tool;
  int32_t run;
  int32_t pass;  ///< 0 stationary, 1 in, 2 out, 3 repeat
  int32_t pass_number;
  int32_t number;
  int32_t revision;   ///< counts up when the station comes again, better known
  int32_t status;     ///< 0 provisional, 1 field, 2 definitive, 3 rejected, 4 superseded
  int32_t kind;       ///< 0 tie-in, 1 gyrocompass, 2 continuous, 3 still
  uint32_t quality;   ///< bits WELLGYRO_QUALITY_...; 0: good
  uint32_t reserved;  ///< 0
  double md_m;
  double inclination_rad;
  double azimuth_true_rad;
  double toolface_rad;
  double north_m;
  double east_m;
  double tvd_m;
  double cov_md_inc_azi[9];   ///< md, inclination, azimuth [m, rad, rad]
  double cov_position_m2[9];  ///< north, east, TVD
} wellgyro_station;

/// A station and the direction of the hole there, which is regular at every inclination.
typedef struct wellgyro_directed_station {
  wellgyro_station station;
  double tangent[3];           ///< the hole's unit tangent: north, east, down
  double cov_tangent_rad2[9];  ///< its covariance, row by row: none along it, but where unfit
} wellgyro_directed_station;

/// Version of the library, as "0.1.0".
WELLGYRO_C const char* wellgyro_version(void);

/// A session from the job file at `path`. `*session` gets null where it fails; then
/// wellgyro_error(NULL) of the same thread says why, with file and line.
WELLGYRO_C int wellgyro_open(const char* path, wellgyro_session** session);
/// The same from the job's text, whose file names are relative to `folder`.
WELLGYRO_C int wellgyro_open_text(const char* text, const char* folder, wellgyro_session** session);

/// Hands in what came, in its order. Data that cannot be used are left out and counted.
WELLGYRO_C int wellgyro_push_imu(wellgyro_session* session, const wellgyro_imu* samples,
                                 size_t count);
/// The same of readings of the depth system.
WELLGYRO_C int wellgyro_push_depth(wellgyro_session* session, const wellgyro_depth* marks,
                                   size_t count);

/// Takes up to `capacity` of the stations that came or were revised since they were last asked
/// for, in the order in which they came; `*count` gets how many.
WELLGYRO_C int wellgyro_poll(wellgyro_session* session, wellgyro_station* stations, size_t capacity,
                             size_t* count);
/// The same with directions. One station is given by one of the two.
WELLGYRO_C int wellgyro_poll_directed(wellgyro_session* session,
                                      wellgyro_directed_station* stations, size_t capacity,
                                      size_t* count);

/// How many faults there were since the beginning. One may tell of a whole batch of data that was
/// left out, or of something else that is wrong; the sentence of the last is wellgyro_error.
WELLGYRO_C int64_t wellgyro_refused(const wellgyro_session* session);

/// Revises all stations from all that is known so far; changes nothing that follows.
WELLGYRO_C int wellgyro_adjust(wellgyro_session* session);

/// The last revision. After it nothing can be pushed. WELLGYRO_UNUSABLE: there is no survey.
/// WELLGYRO_OK does not say that the survey passes: that is wellgyro_verdict.
WELLGYRO_C int wellgyro_finish(wellgyro_session* session);

/// What the survey of `tool` is worth as it is now: `*verdict` gets one of WELLGYRO_VERDICT_...,
/// and `causes` why in words, a line each, with its ending zero; `*size` gets the bytes that these
/// take. Where `capacity` is less, the causes are not written and the answer is WELLGYRO_USAGE;
/// with null `causes` and null `size` the verdict alone is asked for. WELLGYRO_UNUSABLE: there is
/// no survey, and the verdict is WELLGYRO_VERDICT_FAIL.
WELLGYRO_C int wellgyro_verdict(wellgyro_session* session, int32_t tool, int32_t* verdict,
                                char* causes, size_t capacity, size_t* size);

/// survey.csv of `tool` as it is now, with its ending zero, into `text`; `*size` gets the bytes
/// that it takes. Where `capacity` is less, nothing is written and the answer is WELLGYRO_USAGE.
WELLGYRO_C int wellgyro_survey_csv(wellgyro_session* session, int32_t tool, char* text,
                                   size_t capacity, size_t* size);

/// What the last call of the session, or where it is null of the thread's last call that opened
/// one or was given none, had to say; never null. Holds until the next call.
WELLGYRO_C const char* wellgyro_error(const wellgyro_session* session);

/// Ends a session; null is allowed.
WELLGYRO_C void wellgyro_close(wellgyro_session* session);

#ifdef __cplusplus
}
#endif

#endif
