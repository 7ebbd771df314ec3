#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/mesh/surface.hpp"
#include "tools/lab/cases/case_problem.hpp"
#include "tools/lab/shapes/hanging_beam.hpp"
#include "tools/lab/shapes/weight_statics.hpp"

namespace palpate::shapes {

/// Pose of the free end block in the plane of sag: m, rad about z.
struct BlockPose {
  Eigen::Vector2d centre;
  double rotation = 0;
};

/// Finite element model of a hanging beam of one or two materials, clamped at x = 0.
class BeamModel {
 public:
  /// `parts` as in BeamCase.
  BeamModel(const HangingBeams& beams, const std::vector<BeamPart>& parts);

  int node_count() const { return problem_.body.mesh.node_count(); }

  /// Ready to be solved with a Young's modulus (Pa) for each part.
  cases::CaseProblem problem(const std::vector<double>& moduli) const;

  /// Positions at rest under the weight, 3 x n, m. Throws as rest_under_weight().
  Eigen::Matrix3Xd rest(const std::vector<double>& moduli, Law law) const {
    return rest_under_weight(problem(moduli), law);
  }

  /// Least-squares rigid motion of the block's eight corners.
  BlockPose block_pose(const Eigen::Matrix3Xd& positions) const;

  /// Positions (3 x n, m) of material points at rest.
  Eigen::Matrix3Xd at(const Eigen::Matrix3Xd& rest, const Eigen::Matrix3Xd& positions) const;

  /// Boundary as flat triangles between all of its nodes; `is_end`: whether one belongs to the
  /// block's outer end face.
  const Eigen::Matrix3Xi& triangles() const { return triangles_; }
  const std::vector<bool>& is_end() const { return is_end_; }

 private:
  cases::CaseProblem problem_;
  std::vector<int> part_of_;        // of each element; empty: one part
  Eigen::Matrix3Xd block_corners_;  // m, at rest
  Eigen::Matrix3Xi triangles_;
  std::vector<bool> is_end_;
};

/// Young's modulus (Pa) of a beam of one material at which the block's centre hangs at `height` (m,
/// y). `deviation` (Pa) follows from that of the height.
struct DropFit {
  double young_modulus = 0;
  double deviation = 0;
};
/// Throws std::runtime_error if no modulus between 1 kPa and 1 GPa gives that height.
DropFit fit_to_drop(const BeamModel& model, double height, double height_deviation, Law law);

}  // namespace palpate::shapes
