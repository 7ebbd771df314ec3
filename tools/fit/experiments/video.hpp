#pragma once

#include <Eigen/Core>
#include <filesystem>

#include "rt/config/node.hpp"
#include "tools/fit/experiments/uniaxial_data.hpp"

namespace palpate::fit {

/// Widths of a bar from a camera with a clock of its own, at the times of the test. In YAML: a
/// recording with the columns `time`, `width` and `height` (along the axis).
///
/// The camera's clock is shifted so that the turns of its strain, by the height, lie on those of
/// the machine's strain: by the median difference of the peaks, paired in order from the first of
/// the one and the first, second, ... of the other, whichever pairs most of them with the least
/// spread. NaN where the camera did not see. Throws import::CsvError where fewer than two peaks can
/// be paired.
Eigen::VectorXd aligned_widths(const config::Node& node, const std::filesystem::path& folder,
                               const UniaxialData& data);

/// What has to be added to the times of `other`; `spread` is the greatest difference of a peak from
/// that. False where fewer than two peaks can be paired.
bool find_shift(const Eigen::VectorXd& time, const Eigen::VectorXd& strain,
                const Eigen::VectorXd& other_time, const Eigen::VectorXd& other, double& shift,
                double& spread);

}  // namespace palpate::fit
