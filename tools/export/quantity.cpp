#include "tools/export/quantity.hpp"

namespace palpate::exporting {

QuantityText text_of(Quantity quantity) {
  switch (quantity) {
    case Quantity::kDisplacement:
      return {"displacement", "mm", 1e3};
    case Quantity::kDeviation:
      return {"deviation from truth", "mm", 1e3};
    case Quantity::kUncertainty:
      return {"standard deviation", "mm", 1e3};
    case Quantity::kStrain:
      return {"equivalent strain", "%", 100};
    case Quantity::kStress:
      return {"von Mises stress", "kPa", 1e-3};
    case Quantity::kNone:
      break;
  }
  return {};
}

Eigen::VectorXd values_at_nodes(const Instant& instant, Quantity quantity) {
  const bool is_estimate = instant.estimate_mesh != nullptr;
  const ShapeEvaluator* evaluator = is_estimate ? instant.estimate_mesh : instant.truth_mesh;
  if (evaluator == nullptr) return {};
  const Eigen::Matrix3Xd& x = is_estimate ? instant.estimate : instant.truth;
  const auto& stiffness = is_estimate ? instant.stiffness : instant.truth_stiffness;
  switch (quantity) {
    case Quantity::kDisplacement:
      return (x - evaluator->mesh().nodes).colwise().norm();
    case Quantity::kDeviation:
      return instant.deviation.colwise().norm();
    case Quantity::kUncertainty:
      return instant.node_deviation;
    case Quantity::kStrain:
      return evaluator->at_nodes(evaluator->at(x, {}).equivalent_strain);
    case Quantity::kStress:
      if (!stiffness) return {};
      return evaluator->at_nodes(evaluator->at(x, stiffness).von_mises);
    case Quantity::kNone:
      break;
  }
  return {};
}

bool has_quantity(const Instant& instant, Quantity quantity) {
  const bool is_estimate = instant.estimate_mesh != nullptr;
  switch (quantity) {
    case Quantity::kDeviation:
      return instant.deviation.cols() > 0;
    case Quantity::kUncertainty:
      return instant.node_deviation.size() > 0;
    case Quantity::kStress:
      return (is_estimate ? instant.stiffness : instant.truth_stiffness).has_value();
    default:
      return true;
  }
}

}  // namespace palpate::exporting
