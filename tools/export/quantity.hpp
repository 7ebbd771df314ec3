#pragma once

#include <string>

#include "tools/export/shape_follower.hpp"

namespace palpate::exporting {

/// Quantity shown by the colour of a shape.
enum class Quantity { kNone, kDisplacement, kDeviation, kUncertainty, kStrain, kStress };

/// Presentation of a quantity: caption of its colour bar, and the factor for its unit.
struct QuantityText {
  std::string name, unit;
  double factor = 1;
};
QuantityText text_of(Quantity quantity);

/// The quantity at the nodes of the solid shape: the estimate, or the truth if there is no
/// estimate; SI. Empty if the instant does not provide it.
Eigen::VectorXd values_at_nodes(const Instant& instant, Quantity quantity);

/// Whether an instant provides the quantity.
bool has_quantity(const Instant& instant, Quantity quantity);

}  // namespace palpate::exporting
