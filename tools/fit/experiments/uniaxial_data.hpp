#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "rt/config/node.hpp"

namespace palpate::fit {

/// A bar's test as it was recorded, in the direction of the test: strain and load are positive
/// where the bar is pulled in tension, pressed in compression.
struct UniaxialData {
  std::string name;
  bool is_compression = false;
  double length = 1;          // m, at rest; 1 where strain was recorded
  double area = 1;            // m^2, at rest; 1 where stress was recorded
  bool is_stress = false;     // load is nominal stress
  Eigen::VectorXd time;       // s; empty: none
  Eigen::VectorXd strain;     // nominal, by row
  Eigen::VectorXd load;       // N or Pa
  Eigen::VectorXd width;      // m; NaN: not seen; empty: none
  double load_deviation = 1;  // of a sample
  double width_deviation = 1;
  std::vector<bool> is_used;      // by row: fitted or held out
  std::vector<bool> is_held_out;  // by row
};

/// Reads the recording of kind `uniaxial` (uniaxial.hpp says which keys). Throws config::Error and
/// import::CsvError.
UniaxialData read_uniaxial(const config::Node& node, const std::filesystem::path& folder);

}  // namespace palpate::fit
