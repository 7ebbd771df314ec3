#pragma once

#include "core/shape/material_feature.hpp"

namespace palpate::control {

/// Vision input for controllers that require it: identified markers at the feature's own points
/// replace the model's positions of these points. Node positions are modified as little as possible
/// (least squares) such that the feature's points coincide with the observed markers; any feature
/// of material points is then evaluated on the observation.
class MarkerObserver {
 public:
  enum class Kind {
    kHeld,   // points keep their last observed position; invalid once vision is lost
    kOffset  // between observations and without vision the model's positions plus the last observed
             // offset are used
  };
  struct Options {
    Kind kind = Kind::kHeld;
    double patience = 0.2;  // s without an observation after which vision counts as lost
  };

  /// Throws std::invalid_argument if a point is not on the mesh.
  MarkerObserver(const mesh::ElementMesh& mesh, const std::vector<Eigen::Vector3d>& rest_points,
                 const Options& options);

  /// Call once per tick. `fresh`: markers have arrived in this tick; `age`: s since their last
  /// arrival. `seen`: positions in O, 3 x number of points, in their order; ignored if the number
  /// differs. `model`: node positions of the model.
  void look(bool fresh, double age, const Eigen::Ref<const Eigen::Matrix3Xd>& seen,
            const Eigen::Matrix3Xd& model) noexcept;

  /// Node positions, 3 x n, after look().
  const Eigen::Matrix3Xd& positions() const noexcept { return positions_; }
  /// False while the positions of the points are unknown.
  bool sees() const noexcept { return sees_; }
  /// An observation has arrived in this tick.
  bool fresh() const noexcept { return fresh_; }
  void reset() noexcept { known_ = sees_ = fresh_ = false; }

 private:
  shape::MaterialPoints points_;
  Options options_;
  Eigen::MatrixXd spread_;  // |support| x points, pseudo-inverse of the interpolation weights
  Eigen::Matrix3Xd seen_, offset_, moved_, positions_;
  bool known_ = false, sees_ = false, fresh_ = false;
};

}  // namespace palpate::control
