#pragma once

#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

#include "rt/config/node.hpp"
#include "tools/fit/recording.hpp"

namespace palpate::fit {

/// Quantities that a selection may name in addition to the recording's own columns, by sample.
using NamedValues = std::vector<std::pair<std::string, Eigen::VectorXd>>;

/// By sample, whether a selection contains it; empty if it contains none. `sample` (from 0) and the
/// recording's columns may always be named. Throws config::Error if the quantity is unknown.
std::vector<bool> selected_samples(const Selection& selection, const config::Node& node,
                                   const std::string& key, const Recording& recording,
                                   const NamedValues& others);

inline const config::Key kHeldOut("held_out", "",
                                  "samples that are predicted, not fitted: true, or {quantity, "
                                  "from, to}");

/// Entry `held_out` of a recording: samples that are predicted, not fitted (Series::is_held_out).
std::vector<bool> held_out_samples(const config::Node& node, const Recording& recording,
                                   const NamedValues& others);

}  // namespace palpate::fit
