#include "tools/lab/shapes/beam_score.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/math/constants.hpp"
#include "tools/common/progress.hpp"
#include "tools/common/table.hpp"

namespace palpate::shapes {
namespace {

using Eigen::Matrix2Xd;
using Eigen::Matrix3Xd;
using Eigen::Vector2d;
using Eigen::Vector3d;
using math::kDegree;

constexpr double kRotationGoal = 2;                   // degrees
constexpr double kEdgeGoal = 2, kUnsureEdgeGoal = 4;  // mm; the latter for edges of 3 mm
constexpr int kSamples = 100;                         // of a line
constexpr double kClampBorder = 3;                    // pixels

/// Points from one place to another, both included.
Matrix3Xd line(const Vector3d& from, const Vector3d& to, int samples = kSamples) {
  Matrix3Xd points(3, samples + 1);
  for (int i = 0; i <= samples; ++i) points.col(i) = from + (to - from) * i / samples;
  return points;
}

/// As the picture shows them on the plane of z, m.
Matrix2Xd seen(const PinholeCamera& camera, const Matrix3Xd& points, double z) {
  Matrix2Xd result(2, points.cols());
  for (int i = 0; i < points.cols(); ++i)
    result.col(i) = camera.onto_plane(points.col(i), z).head<2>();
  return result;
}

Matrix2Xd predicted_edge(const HangingBeams& beams, const BeamCase& recorded,
                         const BeamModel& model, const Matrix3Xd& positions) {
  const Vector3d low = beams.bar.min(), high = beams.bar.max();
  const Matrix3Xd rest = line({high.x(), low.y(), high.z()}, {low.x(), low.y(), high.z()});
  return seen(recorded.camera, model.at(rest, positions), high.z());
}

double rms(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value * value;
  return std::sqrt(sum / static_cast<double>(values.size()));
}

double nearest(const Vector2d& point, const Matrix2Xd& points) {
  return points.cols() == 0 ? std::numeric_limits<double>::infinity()
                            : (points.colwise() - point).colwise().norm().minCoeff();
}

void add_corners(const BeamCase& recorded, const BeamModel& model, const Matrix3Xd& positions,
                 std::vector<ShapeScore>& scores) {
  std::vector<double> errors;
  for (const BeamCorner& corner : recorded.corners) {
    if (corner.rest.x() > -1e-9) continue;  // clamped
    const Matrix3Xd moved = model.at(corner.rest, positions);
    errors.push_back((seen(recorded.camera, moved, corner.rest.z()) - corner.measured).norm() /
                     kMm);
  }
  if (errors.empty()) return;
  const double deviation = recorded.centre_deviation / kMm;
  scores.push_back(
      {"corners, RMS of " + std::to_string(errors.size()), "mm", rms(errors), deviation, {}});
  scores.push_back(
      {"corners, largest", "mm", *std::max_element(errors.begin(), errors.end()), deviation, {}});
}

void add_edge(const HangingBeams& beams, const BeamCase& recorded, const BeamModel& model,
              const Matrix3Xd& positions, std::vector<ShapeScore>& scores) {
  if (recorded.lower_edge.cols() == 0) return;
  const Matrix2Xd edge = predicted_edge(beams, recorded, model, positions);
  std::vector<double> errors;
  for (int i = 0; i < recorded.lower_edge.cols(); ++i)
    errors.push_back(distance_to_line(recorded.lower_edge.col(i), edge) / kMm);
  const double deviation = recorded.edge_deviation / kMm;
  scores.push_back({"lower edge, RMS of " + std::to_string(errors.size()) + " points", "mm",
                    rms(errors), deviation, deviation > kEdgeGoal ? kUnsureEdgeGoal : kEdgeGoal});
  scores.push_back({"lower edge, largest",
                    "mm",
                    *std::max_element(errors.begin(), errors.end()),
                    deviation,
                    {}});
}

/// From each recorded point to the predicted outline. The block's outer end face may be missing in
/// the recorded one, so that the border without it counts, too. Points at the clamp do not count.
void add_silhouette(const HangingBeams& beams, const BeamCase& recorded, const BeamModel& model,
                    const Matrix3Xd& positions, std::vector<ShapeScore>& scores) {
  if (recorded.silhouette.cols() == 0) return;
  const SurfaceOutline outline =
      surface_outline(recorded.camera, positions, model.triangles(), model.is_end());
  Matrix2Xd clamp(2, 5);
  const Vector3d low = beams.bar.min(), high = beams.bar.max();
  constexpr int kAround[5][2] = {{0, 0}, {0, 1}, {1, 1}, {1, 0}, {0, 0}};
  for (int i = 0; i < 5; ++i)
    clamp.col(i) = recorded.camera.project(
        {high.x(), kAround[i][0] ? high.y() : low.y(), kAround[i][1] ? high.z() : low.z()});
  std::vector<double> errors;
  for (int i = 0; i < recorded.silhouette.cols(); ++i) {
    const Vector2d point = recorded.silhouette.col(i);
    if (distance_to_line(point, clamp) < kClampBorder) continue;
    errors.push_back(std::min(nearest(point, outline.whole), nearest(point, outline.without)));
  }
  if (errors.empty()) return;
  const double deviation = recorded.outline_deviation;
  scores.push_back({"silhouette, RMS of " + std::to_string(errors.size()) + " points",
                    "pixels",
                    rms(errors),
                    deviation,
                    {}});
  scores.push_back({"silhouette, largest",
                    "pixels",
                    *std::max_element(errors.begin(), errors.end()),
                    deviation,
                    {}});
}

std::vector<ShapeOutline> outlines_of(const HangingBeams& beams, const BeamCase& recorded,
                                      const BeamModel& model, const Matrix3Xd& positions) {
  const Vector3d bl = beams.bar.min(), bh = beams.bar.max(), kl = beams.block.min(),
                 kh = beams.block.max();
  const double z = bh.z();
  const Vector3d around[] = {{bh.x(), bh.y(), z}, {bl.x(), bh.y(), z}, {bl.x(), kh.y(), z},
                             {kl.x(), kh.y(), z}, {kl.x(), kl.y(), z}, {bl.x(), kl.y(), z},
                             {bl.x(), bl.y(), z}, {bh.x(), bl.y(), z}};
  Matrix3Xd front(3, 0);
  constexpr int kPerSide = 30;
  for (std::size_t i = 0; i + 1 < std::size(around); ++i) {
    const int filled = static_cast<int>(front.cols());
    front.conservativeResize(3, filled + kPerSide + 1);
    front.rightCols(kPerSide + 1) = line(around[i], around[i + 1], kPerSide);
  }
  std::vector<ShapeOutline> outlines{{"front face, predicted",
                                      seen(recorded.camera, model.at(front, positions), z) / kMm,
                                      false, true}};
  if (recorded.lower_edge.cols() > 0)
    outlines.push_back({"lower edge, measured", recorded.lower_edge / kMm, true, true});
  Matrix2Xd corners(2, recorded.corners.size());
  for (std::size_t i = 0; i < recorded.corners.size(); ++i)
    corners.col(i) = recorded.corners[i].measured / kMm;
  outlines.push_back({"corners, measured", corners, true, false});
  return outlines;
}

std::string text_of(const std::string& material, double modulus, const std::string& origin) {
  return material + ": E " + common::number(1e-3 * modulus, 1) + " kPa, " + origin;
}

/// A modulus for a part, and where it comes from; 0 if there is none.
struct Modulus {
  double value = 0;
  std::string origin;
};

class Predictions {
 public:
  Predictions(const std::vector<HangingBeams>& recordings,
              const std::map<std::string, double>& given, Law law)
      : given_(given), law_(law) {
    for (const HangingBeams& beams : recordings)
      for (const BeamCase& c : beams.cases) all_.push_back({&beams, &c});
    for (const auto& [beams, pointer] : all_) {
      const BeamCase& c = *pointer;
      if (c.parts.size() > 1 || given.count(c.parts[0].material) > 0) continue;
      common::Progress progress(static_cast<int>(fits_.size()) + 1, static_cast<int>(all_.size()),
                                c.recording + ", " + name_of(law) + ": fit to the drop");
      const DropFit fit =
          fit_to_drop(BeamModel(*beams, c.parts), c.centre.y(), c.centre_deviation, law);
      fits_[c.recording] = fit;
      progress.finish(true, common::number(1e-3 * fit.young_modulus, 1) + " kPa");
    }
  }

  std::vector<ShapeResult> all() const {
    std::vector<ShapeResult> results;
    for (const auto& [beams, pointer] : all_) {
      const BeamCase& c = *pointer;
      if (c.parts.size() > 1 && law_ == Law::kHyperelastic) continue;
      const auto fit = fits_.find(c.recording);
      if (fit != fits_.end())
        results.push_back(predict(*beams, c,
                                  {{fit->second.young_modulus,
                                    "fitted to the drop alone, sd " +
                                        common::number(1e-3 * fit->second.deviation, 1) + " kPa"}},
                                  true));
      std::vector<Modulus> moduli;
      std::string missing;
      for (const BeamPart& part : c.parts) {
        moduli.push_back(from_others(part.material, c.recording));
        if (moduli.back().value == 0) missing = part.material;
      }
      if (missing.empty()) {
        results.push_back(predict(*beams, c, moduli, false));
      } else if (fit == fits_.end()) {
        results.push_back({});
        results.back().recording = c.recording;
        results.back().model = name_of(law_);
        results.back().notes = {"NOT PREDICTED: no other beam is of " + missing +
                                " alone; give its modulus with --modulus '" + missing + "=KPA'"};
      }
    }
    return results;
  }

 private:
  Modulus from_others(const std::string& material, const std::string& but) const {
    const auto given = given_.find(material);
    if (given != given_.end()) return {given->second, "given"};
    double logarithms = 0;
    int count = 0;
    std::string names;
    for (const auto& [beams, pointer] : all_) {
      const BeamCase& c = *pointer;
      const auto fit = fits_.find(c.recording);
      if (fit == fits_.end() || c.recording == but || c.parts[0].material != material) continue;
      logarithms += std::log(fit->second.young_modulus);
      names += (count++ > 0 ? ", " : "") + c.name;
    }
    if (count == 0) return {};
    return {std::exp(logarithms / count), "fitted on " + names};
  }

  ShapeResult predict(const HangingBeams& beams, const BeamCase& c,
                      const std::vector<Modulus>& moduli, bool is_fitted) const {
    const BeamModel model(beams, c.parts);
    std::vector<double> values;
    ShapeResult result;
    for (std::size_t i = 0; i < moduli.size(); ++i) {
      values.push_back(moduli[i].value);
      result.material +=
          (i > 0 ? "; " : "") + text_of(c.parts[i].material, moduli[i].value, moduli[i].origin);
    }
    const Matrix3Xd positions = model.rest(values, law_);
    result.recording = c.recording;
    result.model = name_of(law_);
    result.nodes = model.node_count();
    if (law_ == Law::kCorotational)
      result.incremental_deviation = incremental_deviation(model.problem(values), positions);
    result.scores = compare_beam(beams, c, model, positions, is_fitted);
    result.outlines = outlines_of(beams, c, model, positions);
    if (c.is_interface_assumed)
      result.notes.push_back(
          "no interface_rest_x_mm: the materials are taken to meet in the "
          "middle of the bar");
    return result;
  }

  std::vector<std::pair<const HangingBeams*, const BeamCase*>> all_;
  const std::map<std::string, double>& given_;
  Law law_;
  std::map<std::string, DropFit> fits_;  // by recording
};

}  // namespace

std::vector<ShapeScore> compare_beam(const HangingBeams& beams, const BeamCase& recorded,
                                     const BeamModel& model, const Matrix3Xd& positions,
                                     bool is_fitted) {
  const BlockPose pose = model.block_pose(positions);
  const Vector2d error = (pose.centre - recorded.centre) / kMm;
  const double deviation = recorded.centre_deviation / kMm;
  const double turn = std::remainder(pose.rotation - recorded.rotation, 2 * M_PI) / kDegree;
  std::vector<ShapeScore> scores{
      {"block's drop (y)", "mm", error.y(), deviation, {}, is_fitted},
      {"block's x", "mm", error.x(), deviation, {}},
      {"block's rotation", "degrees", turn, recorded.rotation_deviation / kDegree, kRotationGoal}};
  add_corners(recorded, model, positions, scores);
  add_edge(beams, recorded, model, positions, scores);
  add_silhouette(beams, recorded, model, positions, scores);
  return scores;
}

std::vector<ShapeResult> score_hanging_beams(const std::vector<HangingBeams>& recordings,
                                             const std::map<std::string, double>& given) {
  std::vector<ShapeResult> results;
  for (const Law law : {Law::kCorotational, Law::kHyperelastic})
    for (ShapeResult& result : Predictions(recordings, given, law).all())
      results.push_back(std::move(result));
  return results;
}

}  // namespace palpate::shapes
