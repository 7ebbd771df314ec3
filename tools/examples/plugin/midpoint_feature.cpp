#include "midpoint_feature.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace example {

palpate::config::OptionTable<MidpointFeature::Options> MidpointFeature::table() {
  return palpate::config::OptionTable<Options>()
      .vector3("first", "m", "point of the rest shape, in O", {-100, 100}, &Options::first)
      .required()
      .vector3("second", "m", "point of the rest shape, in O", {-100, 100}, &Options::second)
      .required();
}

MidpointFeature::MidpointFeature(const Options& options, const palpate::elasticity::Body& body)
    : rest_points_{options.first, options.second}, jacobian_(3, 6) {
  for (const Eigen::Vector3d& point : rest_points_) {
    Eigen::Index node = 0;
    (body.mesh.nodes.colwise() - point).colwise().squaredNorm().minCoeff(&node);
    support_.push_back(static_cast<int>(node));
  }
  if (support_[0] == support_[1])
    throw std::invalid_argument("first and second have the same nearest node");
  for (int column = 0; column < 6; ++column) jacobian_.insert(column % 3, column) = 0.5;
  jacobian_.makeCompressed();
}

void MidpointFeature::evaluate(const Eigen::Matrix3Xd& positions,
                               Eigen::Ref<Eigen::VectorXd> value) {
  value = 0.5 * (positions.col(support_[0]) + positions.col(support_[1]));
}

void MidpointFeature::error(const Eigen::Ref<const Eigen::VectorXd>& value,
                            const Eigen::Ref<const Eigen::VectorXd>& target,
                            Eigen::Ref<Eigen::VectorXd> error) const {
  error = target - value;
}

bool MidpointFeature::is_valid_target(const double* target, int count) const {
  return count == 3 &&
         std::all_of(target, target + count, [](double number) { return std::isfinite(number); });
}

}  // namespace example
