#pragma once

#include "core/shape/material_points.hpp"

namespace palpate::published_control {

/// How a controller that needs vision is served: markers at the feature's own points, told apart,
/// take the place of what the model says of these points. Nodal positions are moved as little as
/// possible (least squares) for the feature's points to lie where their markers have been seen; so
/// any feature of material points is evaluated on what was seen of it.
class MarkerSight {
 public:
  enum class Kind {
    kHeld,   // points stay where they were last seen; no word of them once sight is lost
    kOffset  // the model goes on between two looks and without sight, displaced as last seen
  };
  struct Options {
    Kind kind = Kind::kHeld;
    double patience = 0.2;  // s without a look, after which sight is lost
  };

  /// Throws std::invalid_argument where a point is not of the mesh.
  MarkerSight(const mesh::ElementMesh& mesh, const std::vector<Eigen::Vector3d>& rest_points,
              const Options& options);

  /// Once a tick. `fresh`: markers have come in this tick, `age` s after they last came. seen: 3 x
  /// as many as there are points, in O, in their order; another number is not looked at.
  void look(bool fresh, double age, const Eigen::Ref<const Eigen::Matrix3Xd>& seen,
            const Eigen::Matrix3Xd& model) noexcept;

  /// Nodal positions, 3 x n, after look().
  const Eigen::Matrix3Xd& positions() const noexcept { return positions_; }
  /// False while nothing is known of the points.
  bool sees() const noexcept { return sees_; }
  /// A look has come in this tick.
  bool fresh() const noexcept { return fresh_; }
  void reset() noexcept { known_ = sees_ = fresh_ = false; }

 private:
  shape::MaterialPoints points_;
  Options options_;
  Eigen::MatrixXd spread_;  // |support| x points, pseudo-inverse of the points' weights
  Eigen::Matrix3Xd seen_, offset_, moved_, positions_;
  bool known_ = false, sees_ = false, fresh_ = false;
};

}  // namespace palpate::published_control
