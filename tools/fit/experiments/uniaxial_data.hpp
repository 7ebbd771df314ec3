#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "rt/config/node.hpp"

namespace palpate::fit {

/// A recorded bar test, in the direction of the test: strain and load are positive when the bar is
/// pulled in tension, pressed in compression.
struct UniaxialData {
  std::string name;
  bool is_compression = false;
  double length = 1;          // m, at rest; 1 if strain was recorded
  double area = 1;            // m^2, at rest; 1 if stress was recorded
  bool is_stress = false;     // load is nominal stress
  Eigen::VectorXd time;       // s; empty: none
  Eigen::VectorXd strain;     // nominal, by row
  Eigen::VectorXd load;       // N or Pa
  Eigen::VectorXd width;      // m; NaN: not observed; empty: none
  double load_deviation = 1;  // of a sample
  double width_deviation = 1;
  std::vector<bool> is_used;      // by row: fitted or held out
  std::vector<bool> is_held_out;  // by row
};

/// Reads the recording of kind `uniaxial` (uniaxial.hpp lists the keys). Throws config::Error and
/// import::CsvError.
UniaxialData read_uniaxial(const config::Node& node, const std::filesystem::path& folder);

}  // namespace palpate::fit
