#pragma once

#include <filesystem>

#include "tools/lab/runs/experiments.hpp"

namespace palpate::scores {

/// The feature of `target` in the shape that the plant of `scene` itself takes once its hand has
/// moved by `motion` and everything has come to rest: a target that can be reached, whatever the
/// estimator's model. Runs the simulator without any daemon. Throws config::Error.
Eigen::VectorXd reached_value(const std::filesystem::path& scene, const runs::ControlTarget& target,
                              const runs::HandMotion& motion);

}  // namespace palpate::scores
