#pragma once

#include <array>
#include <cstdint>

#include "core/math/rigid.hpp"

namespace palpate::estimation {

/// What may explain wrenches that contradict the model. The values are part of the message format.
enum class Cause {
  kUnknown,          // none of the others
  kContact,          // external contact; value: force on the object, N
  kSlip,             // the grasp has slipped; value: displacement in the hand, m and rad, in G
  kClampPlace,       // the clamp is elsewhere; value: displacement, m and rad, in O
  kClampCompliance,  // the clamp is compliant; value: compliance, m/N and rad/(N m)
  kUnevenStiffness,  // value: log of stiffness over its nominal value, of the half at the clamp and
                     // of the half at the hand
  kWeight,           // additional weight; value: its force on the object, N
  kSensorBias,       // bias of a force-torque sensor; value: N and N m, in G
};
inline constexpr int kCauses = 8;

/// An explanation of wrenches that contradict the model.
struct Explanation {
  Cause cause = Cause::kUnknown;
  double probability = 0;                                // among all causes
  int hand = 0;                                          // of slip and sensor bias
  Eigen::Vector3d location_O = Eigen::Vector3d::Zero();  // of contact and weight, m
  math::Vector6d value = math::Vector6d::Zero();         // see Cause; unused components are zero
};

/// Whether the wrenches of the hands are consistent with the model, and what explains it if not.
struct DiscrepancyReport {
  std::int64_t tests = 0;  // number of tests so far
  bool is_inconsistent = false;
  double time = 0;  // s since the discrepancy was reported
  /// Most significant squared normalised difference per degree of freedom, that from the prior
  /// relative to its lower threshold; negative: no test yet.
  double test = -1;
  double threshold = -1;
  int hand = 0, axis = 0;  // largest normalised component: force x, y, z, torque x, y, z, in O
  /// Measured minus predicted wrench of each hand at G in O, N and N m, with respect to the earlier
  /// knowledge that it contradicts most, and its standard deviation while the model holds;
  /// negative: no wrench.
  std::array<math::Vector6d, 2> difference{math::Vector6d::Zero(), math::Vector6d::Zero()};
  std::array<math::Vector6d, 2> deviation{math::Vector6d::Constant(-1),
                                          math::Vector6d::Constant(-1)};
  /// Explanations by decreasing probability; none until they have been ranked.
  int count = 0;
  std::array<Explanation, kCauses> explanations{};
  /// Explanation that corrects the estimate since the last discrepancy; kUnknown: none.
  Cause adopted = Cause::kUnknown;
};

}  // namespace palpate::estimation
