#pragma once

#include <string>

#include "tools/export/shape_follower.hpp"

namespace palpate::exporting {

/// What the colour of a shape says.
enum class Quantity { kNone, kDisplacement, kDeviation, kUncertainty, kStrain, kStress };

/// How a quantity is told: caption of its colour bar, and what it is multiplied by for it.
struct QuantityText {
  std::string name, unit;
  double factor = 1;
};
QuantityText text_of(Quantity quantity);

/// The quantity at the nodes of the shape that is drawn solid: the estimate, or the truth where
/// there is no estimate; SI. Empty where the instant does not tell it.
Eigen::VectorXd values_at_nodes(const Instant& instant, Quantity quantity);

/// Whether an instant tells the quantity.
bool tells(const Instant& instant, Quantity quantity);

}  // namespace palpate::exporting
