#pragma once

#include <vector>

#include "core/sensing/sensor_model.hpp"

namespace palpate::contact {

struct NodalLoad {
  int node = 0;
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  // N, in O
};

/// Loads that stem from one contact. Capacity is reserved at set-up: push beyond it is refused.
struct ContactLoads {
  sensing::Source source = sensing::Source::kManual;
  bool accepted = false;  // false: too far from the surface, or loads did not fit
  Eigen::Vector3d location = Eigen::Vector3d::Zero();  // m, that of the contact
  std::vector<NodalLoad> loads;

  bool push(int node, const Eigen::Vector3d& force) noexcept {
    if (loads.size() == loads.capacity()) return false;
    loads.push_back({node, force});
    return true;
  }
};

/// Maps a wrench at a place of the object to nodal loads, and nothing else.
class ForceTransformer {
 public:
  virtual ~ForceTransformer() = default;
  /// How many nodes a contact can load at the most, for reserving.
  virtual int max_nodes() const noexcept = 0;
  /// `contact` with location and wrench in O, location on the deformed object (for kManual: a rest
  /// point); `positions` 3 x n, current. Clears and fills `out`.
  virtual void distribute(const sensing::Contact& contact, const Eigen::Matrix3Xd& positions,
                          ContactLoads& out) noexcept = 0;
};

}  // namespace palpate::contact
