#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

namespace palpate::common {

/// One curve: x, y.
struct Curve {
  std::string title;
  std::vector<double> x;
  std::vector<double> y;
  bool dashed = false;
  int colour = 0;  // from 1 on; 0: one after the other
};

struct Plot {
  std::string title;
  std::string x_label;
  std::string y_label;
  std::vector<Curve> curves;
  bool logarithmic = false;    // y axis
  bool logarithmic_x = false;  // x axis
};

/// Draws plots, one below the other, to a PNG, or an SVG if the name has that extension, with the
/// program gnuplot. Returns false without drawing if gnuplot is not installed; throws
/// std::runtime_error if it fails.
bool draw(const std::vector<Plot>& plots, const std::filesystem::path& picture);

/// Fields by row and column; each column has its colour, whose intensity in a field follows its
/// fraction.
struct ColourMatrix {
  std::string title;
  std::vector<std::string> columns;
  std::vector<unsigned> colours;  // 0xRRGGBB
  std::vector<std::string> rows;
  std::vector<std::vector<double>> shares;  // by row and column, 0 to 1
};

/// As above.
bool draw(const ColourMatrix& matrix, const std::filesystem::path& picture);

}  // namespace palpate::common
