#pragma once

#include <Eigen/Core>
#include <filesystem>

#include "rt/config/node.hpp"
#include "tools/fit/experiments/uniaxial_data.hpp"

namespace palpate::fit {

/// Widths of a bar from a camera with a separate clock, at the times of the test. In YAML: a
/// recording with the columns `time`, `width` and `height` (along the axis).
///
/// The camera's clock is shifted so that the turning points of its strain, from the height,
/// coincide with those of the machine's strain: by the median difference of the peaks, paired in
/// order from the first of one and the first, second, ... of the other, choosing the pairing of
/// most peaks with the smallest spread. NaN where the camera has no measurement. Throws
/// import::CsvError if fewer than two peaks can be paired.
Eigen::VectorXd aligned_widths(const config::Node& node, const std::filesystem::path& folder,
                               const UniaxialData& data);

/// Offset to add to the times of `other`; `spread` is the largest deviation of a peak from it.
/// False if fewer than two peaks can be paired.
bool find_shift(const Eigen::VectorXd& time, const Eigen::VectorXd& strain,
                const Eigen::VectorXd& other_time, const Eigen::VectorXd& other, double& shift,
                double& spread);

}  // namespace palpate::fit
