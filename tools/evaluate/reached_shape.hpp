#pragma once

#include <filesystem>

#include "tools/evaluate/experiments.hpp"

namespace palpate::evaluate {

/// The feature of `target` in the shape that the plant of `scene` itself takes once its hand has
/// moved by `motion` and everything has come to rest: a target that can be reached, whatever the
/// estimator's model. Runs the simulator without any daemon. Throws config::Error.
Eigen::VectorXd reached_value(const std::filesystem::path& scene, const ControlTarget& target,
                              const HandMotion& motion);

}  // namespace palpate::evaluate
