#include "tools/lab/shapes/sponge_score.hpp"

#include <ceres/ceres.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "tools/common/table.hpp"
#include "tools/lab/shapes/sponge_model.hpp"

namespace palpate::shapes {
namespace {

using Eigen::Matrix2Xd;
using Eigen::Vector2d;
using Eigen::VectorXd;

constexpr double kFitted = 0.2, kScored = 0.4;  // depths
constexpr double kOutlineDeviation = 1;         // pixels, of the recording
constexpr double kForceDeviation = 0.05;        // of the force at the end of the fit
constexpr double kOutlineGoal = 0.5;            // % of the length
constexpr double kForceGoal = 15;               // %
constexpr std::array<int, 2> kCells{8, 5};
constexpr double kLargestPoisson = 0.45, kHeightUnit = 20;  // pixels

/// Distance of a point from a closed line, pixels.
double distance(const Vector2d& point, const Matrix2Xd& line) {
  double squared = std::numeric_limits<double>::infinity();
  for (int i = 0; i < line.cols(); ++i) {
    const Vector2d from = line.col(i), along = line.col((i + 1) % line.cols()) - from;
    const double length = along.squaredNorm();
    const double share = length > 0 ? std::clamp(along.dot(point - from) / length, 0.0, 1.0) : 0.0;
    squared = std::min(squared, (from + share * along - point).squaredNorm());
  }
  return std::sqrt(squared);
}

/// Sum of squared distances of a frame's outline from a closed line, pixels^2.
double squared_distances(const SpongeFrame& frame, const Matrix2Xd& line) {
  double sum = 0;
  for (int i = 0; i < frame.outline.cols(); ++i) {
    const double d = distance(frame.outline.col(i), line);
    sum += d * d;
  }
  return sum;
}

/// Frames of the loading branch with a depth in a range, and an outline.
std::vector<int> frames_between(const PushedSponge& sponge, double from, double to) {
  std::vector<int> found;
  for (int k = 0; k <= sponge.last_loading; ++k) {
    const double depth = sponge.depth(sponge.frames[k]);
    if (depth > from && depth <= to && sponge.frames[k].outline.cols() > 0) found.push_back(k);
  }
  return found;
}

/// Root mean square over all points of the frames, % of the length; against the shape at rest if
/// `predicted` is empty.
double outline_error(const PushedSponge& sponge, const std::vector<int>& frames,
                     const std::vector<PredictedSponge>& predicted) {
  double sum = 0;
  Eigen::Index points = 0;
  for (const int k : frames) {
    sum += squared_distances(
        sponge.frames[k], predicted.empty() ? sponge.frames.front().outline : predicted[k].outline);
    points += sponge.frames[k].outline.cols();
  }
  return 100 * std::sqrt(sum / static_cast<double>(points)) / sponge.length();
}

/// Factor of the modulus that fits the forces of these frames best.
double modulus_factor(const PushedSponge& sponge, const std::vector<int>& frames,
                      const std::vector<PredictedSponge>& predicted) {
  double product = 0, squared = 0;
  for (const int k : frames) {
    product += sponge.frames[k].force * predicted[k].force;
    squared += predicted[k].force * predicted[k].force;
  }
  return squared > 0 ? product / squared : 0;
}

/// Residuals of a frame: its outline's root mean square distance and its force, per deviation.
struct SpongeCost {
  const PushedSponge& sponge;
  const SpongeModel& model;
  const std::vector<int>& frames;

  /// Of values without bounds, both of the size of one, which suits relative steps of differences:
  /// the ratio is between 0 and kLargestPoisson.
  SpongeParameters parameters(const double* values) const {
    return {kLargestPoisson / (1 + std::exp(values[0])),
            sponge.contact_height + kHeightUnit * (values[1] - 1)};
  }

  bool operator()(double const* const* values, double* residuals) const {
    const std::vector<PredictedSponge> predicted =
        model.predict(parameters(values[0]), frames.back());
    const double factor = modulus_factor(sponge, frames, predicted);
    const double force_deviation = kForceDeviation * sponge.frames[frames.back()].force;
    for (const int k : frames) {
      const SpongeFrame& frame = sponge.frames[k];
      const double mean = squared_distances(frame, predicted[k].outline) /
                          static_cast<double>(frame.outline.cols());
      *residuals++ = std::sqrt(mean) / kOutlineDeviation;
      *residuals++ = (factor * predicted[k].force - frame.force) / force_deviation;
    }
    return true;
  }
};

SpongeParameters fit(const PushedSponge& sponge, const SpongeModel& model,
                     const std::vector<int>& frames) {
  const SpongeCost residuals{sponge, model, frames};
  std::array<double, 2> values{1.25, 1};  // a ratio of 0.1
  ceres::NumericDiffOptions differences;
  differences.relative_step_size = 0.05;
  auto* cost = new ceres::DynamicNumericDiffCostFunction<SpongeCost, ceres::FORWARD>(
      new SpongeCost(residuals), ceres::TAKE_OWNERSHIP, differences);
  cost->AddParameterBlock(2);
  cost->SetNumResiduals(2 * static_cast<int>(frames.size()));
  ceres::Problem problem;
  problem.AddResidualBlock(cost, nullptr, values.data());
  ceres::Solver::Options options;
  options.max_num_iterations = 8;
  options.function_tolerance = options.parameter_tolerance = 1e-3;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  if (!summary.IsSolutionUsable()) throw std::runtime_error(sponge.recording + ": no fit");
  return residuals.parameters(values.data());
}

}  // namespace

ShapeResult score_pushed_sponge(const PushedSponge& sponge) {
  const SpongeModel model(sponge, kCells);
  const std::vector<int> fitted = frames_between(sponge, 0, kFitted);
  const std::vector<int> scored = frames_between(sponge, kFitted, kScored);
  if (fitted.size() < 2 || scored.empty())
    throw std::runtime_error(sponge.recording +
                             ": has fewer than two frames to 20 % depth, or none to 40 %");
  const SpongeParameters parameters = fit(sponge, model, fitted);
  const std::vector<PredictedSponge> predicted = model.predict(parameters, scored.back());
  const double factor = modulus_factor(sponge, fitted, predicted);

  ShapeResult result;
  result.recording = sponge.recording;
  result.model = "co-rotational, dynamic, table and finger as obstacles";
  result.nodes = model.nodes();
  result.material = "E times thickness " +
                    common::number(1e-3 * factor * SpongeModel::kModulus * kThickness, 3) +
                    " N/mm, Poisson's ratio " + common::number(parameters.poisson_ratio, 2) +
                    ", first contact at " + common::number(parameters.contact_height, 1) +
                    " pixels, fitted to 20 % depth";
  const double undeformed = outline_error(sponge, scored, {});
  double force_error = 0;
  for (const int k : scored) {
    const double error = 100 * (factor * predicted[k].force / sponge.frames[k].force - 1);
    if (std::abs(error) > std::abs(force_error)) force_error = error;
  }
  const double pixel = 100 / sponge.length();  // % of the length: the recording's accuracy
  result.scores = {
      {"outline RMS to 20 % depth",
       "% of length",
       outline_error(sponge, fitted, predicted),
       pixel,
       {},
       true},
      {"outline RMS, 20 to 40 % depth", "% of length", outline_error(sponge, scored, predicted),
       pixel, std::min(kOutlineGoal, 0.5 * undeformed)},
      {"the same, of the outline at rest", "% of length", undeformed, pixel, {}},
      {"force, largest error, 20 to 40 % depth", "%", force_error, 0, kForceGoal}};
  result.notes.push_back("no scale is recorded: drawn with " + common::number(kPixel / kMm, 2) +
                         " mm a pixel");
  const SpongeFrame& last = sponge.frames[scored.back()];
  const double mm = kPixel / kMm;
  const auto drawn = [mm](const Matrix2Xd& outline) -> Matrix2Xd {
    Matrix2Xd up = mm * outline;
    up.row(1) *= -1;
    return up;
  };
  Matrix2Xd closed(2, predicted.back().outline.cols() + 1);
  closed << predicted.back().outline, predicted.back().outline.col(0);
  result.outlines = {
      {"outline, predicted", drawn(closed), false, true},
      {"outline, measured", drawn(last.outline), true, false},
      {"outline at rest, measured", drawn(sponge.frames.front().outline), true, false}};
  return result;
}

}  // namespace palpate::shapes
