#pragma once

#include <string>
#include <vector>

#include "tools/fit/held/held_log.hpp"

namespace palpate::fit {

/// The hand at rest, or nearly so.
struct HeldSample {
  double time = 0;  // s since the start of the recording
  math::Pose X_WE = math::Pose::Identity();
  math::Wrench F_S;             // as reported by the sensor
  Eigen::Matrix3Xd points_W;    // m, observed on the surface; none without an observation
  std::vector<math::Pose> way;  // X_WE on the path from the previous sample
};

struct HeldRecording {
  std::vector<HeldSample> samples;
  math::Vector6d deviation;    // standard, of F_S of one sample: from the scatter of its blocks
  double point_deviation = 0;  // m, of each coordinate
};

/// The samples of a log by the rule. `average_points`: all messages of a window contain the same
/// points in the same order (markers); otherwise the message in its middle is used. Throws as
/// read_held_log() does, and if there is no sample at all.
HeldRecording read_held_recording(const std::string& log, const CalmRule& rule,
                                  const std::string& time, bool average_points);

}  // namespace palpate::fit
