#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

#include <gtest/gtest.h>

#include "wellgyro/depth/depth_track.h"

#include "depth/utc.h"

namespace wellgyro {

inline DepthMark Mark(double seconds, double md, std::int64_t seq, std::int32_t session = 1) {
  DepthMark mark;
  mark.utc = Utc(seconds);
  mark.seq = seq;
  mark.session = session;
  mark.md = md;
  return mark;
}

inline Event DepthEvent(Event::Kind kind, double seconds, double value, std::int32_t id) {
  Event event;
  event.kind = kind;
  event.utc = Utc(seconds);
  event.has_value = true;
  event.value_m = value;
  event.event_id = id;
  return event;
}

/// Marks of an encoder of 1 cm counts.
inline std::vector<DepthMark> Encoder(double seconds, double rate,
                                      const std::function<double(double)>& md) {
  std::vector<DepthMark> marks;
  for (int i = 0; i <= std::lround(seconds * rate); ++i) {
    const double t = i / rate;
    marks.push_back(Mark(t, std::floor(md(t) * 100) / 100 + 0.005, i));
  }
  return marks;
}

/// Of marks that are all taken.
inline DepthTrack Track(const std::vector<DepthMark>& marks) {
  DepthTrack track;
  for (const auto& mark : marks) EXPECT_FALSE(track.Push(mark).has_value());
  return track;
}

}  // namespace wellgyro
