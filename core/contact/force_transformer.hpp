#pragma once

#include <vector>

#include "core/sensing/sensor_model.hpp"

namespace palpate::contact {

struct NodalLoad {
  int node = 0;
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  // N, in O
};

/// Nodal loads of one contact. Capacity is reserved at set-up; push() beyond it is rejected.
struct ContactLoads {
  sensing::Source source = sensing::Source::kManual;
  bool accepted = false;  // false: too far from the surface, or insufficient capacity
  Eigen::Vector3d location = Eigen::Vector3d::Zero();  // m, location of the contact
  std::vector<NodalLoad> loads;

  bool push(int node, const Eigen::Vector3d& force) noexcept {
    if (loads.size() == loads.capacity()) return false;
    loads.push_back({node, force});
    return true;
  }
};

/// Maps a wrench at a location on the object to nodal loads.
class ForceTransformer {
 public:
  virtual ~ForceTransformer() = default;
  /// Maximum number of nodes loaded by one contact, for reserving capacity.
  virtual int max_nodes() const noexcept = 0;
  /// `contact`: location and wrench in O, the location on the deformed object (for kManual: in the
  /// rest shape); `positions`: current node positions, 3 x n, m. Clears and fills `out`.
  virtual void distribute(const sensing::Contact& contact, const Eigen::Matrix3Xd& positions,
                          ContactLoads& out) noexcept = 0;
};

}  // namespace palpate::contact
