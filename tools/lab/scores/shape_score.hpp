#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/math/rigid.hpp"
#include "tools/log/log_reader.hpp"
#include "tools/log/plant_truth.hpp"

namespace palpate::scores {

/// Distance of the estimate's nodes from the plant's corresponding material points, at one time.
struct ShapeErrorSample {
  double time = 0;          // s since the first shape
  double mean = 0;          // m, over the nodes
  double rms = 0;           // m
  double maximum = 0;       // m
  double displacement = 0;  // m, largest true displacement from rest
};

/// Mean, RMS and maximum over nodes and time, m.
struct ErrorSummary {
  double mean = 0;
  double rms = 0;
  double maximum = 0;
};

/// An interval in which the hand stood still, s since the first shape; error over its last half
/// second.
struct HoldScore {
  double begin = 0;
  double end = 0;
  ErrorSummary error;
  double displacement = 0;  // m, largest true displacement from rest
};

struct ShapeScore {
  double length = 0;  // m, largest side of the object
  std::vector<ShapeErrorSample> samples;
  ErrorSummary whole;
  ErrorSummary in_motion;           // outside the intervals in which the hand stood still; 0: none
  std::vector<HoldScore> holds;     // the poses, without the initial one
  double largest_displacement = 0;  // m
  long shapes = 0;
  long not_current = 0;  // shapes that were marked stale or not converged

  /// Over the ends of all holds; the whole run if there is none.
  ErrorSummary at_holds() const;
  /// Median over the holds of their mean errors, which one hold cannot decide, m.
  double median_hold() const;
};

/// Mean, RMS and maximum of samples[first, last).
ErrorSummary summarise(const std::vector<ShapeErrorSample>& samples, std::size_t first,
                       std::size_t last);

/// Intervals of at least `least` seconds in which the plant's grasp neither moved nor rotated
/// (below 2 mm/s and 0.02 rad/s), utime in us.
struct Interval {
  std::int64_t begin, end;
};
std::vector<Interval> find_holds(const std::vector<truth_contact_t>& contacts, double least);

/// Compares every SHAPE with the ground truth of the same instant at all nodes of the estimate
/// (TruthPoints). X_OP: pose of the plant's O (P) in palpated's O. Throws std::runtime_error if the
/// log lacks shape, truth or meshes.
ShapeScore score_shape(const log::RunLog& run, const math::Pose& X_OP = math::Pose::Identity());

}  // namespace palpate::scores
