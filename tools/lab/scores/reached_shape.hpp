#pragma once

#include <filesystem>

#include "tools/lab/runs/experiments.hpp"

namespace palpate::scores {

/// The feature of `target` in the equilibrium shape of the plant of `scene` after its hand has
/// moved by `motion`: a reachable target, independent of the estimator's model. Runs the simulator
/// without a daemon. Throws config::Error.
Eigen::VectorXd reached_value(const std::filesystem::path& scene, const runs::ControlTarget& target,
                              const runs::HandMotion& motion);

}  // namespace palpate::scores
