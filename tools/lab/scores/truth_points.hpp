#pragma once

#include "core/math/rigid.hpp"
#include "tools/log/plant_truth.hpp"

namespace palpate::scores {

/// The plant's rest points that correspond to those of the estimate: of the same coordinates
/// relative to the object's bounding box, where palpated has the dimensions of the same object
/// wrong (by less than a tenth); unchanged where the boxes are equal or of different objects. Both
/// 3 x n, m, in O of plant and of palpated.
Eigen::Matrix3Xd corresponding_points(const log::MeshMessage& plant,
                                      const log::MeshMessage& estimate,
                                      const Eigen::Matrix3Xd& rest_points);

/// True positions of material points that palpated names by its own rest coordinates. Where the
/// object lies elsewhere than palpated is configured for, points that coincide in W coincide.
class TruthPoints {
 public:
  /// rest_points: 3 x n, of the estimate, m. X_OP: pose of the plant's O (P) in palpated's O.
  /// Throws as log::PlantPoints does.
  TruthPoints(const log::MeshMessage& plant, const log::MeshMessage& estimate,
              const Eigen::Matrix3Xd& rest_points, const math::Pose& X_OP);

  /// For the plant's nodes in its own O, 3 x n in palpated's O, m.
  Eigen::Matrix3Xd at(const Eigen::Matrix3Xd& plant_positions) const;

 private:
  log::PlantPoints points_;
  math::Pose X_OP_;
};

}  // namespace palpate::scores
