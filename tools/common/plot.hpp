#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace palpate::common {

/// One curve: x, y; interrupted where y is not finite.
struct Curve {
  std::string title;
  std::vector<double> x;
  std::vector<double> y;
  bool dashed = false;
};

struct Plot {
  std::string title;
  std::string x_label;
  std::string y_label;
  std::vector<Curve> curves;
  bool logarithmic = false;    // y axis
  bool logarithmic_x = false;  // x axis
};

/// Draws plots, one below the other, to a PNG, or an SVG if the name has that extension, by
/// tools/common/plots.py. Throws Interrupted, and std::runtime_error with the reason if there is no
/// picture, e.g. because matplotlib is not installed.
void draw(const std::vector<Plot>& plots, const std::filesystem::path& picture);

/// The same for a picture that may be missing: returns false after printing the reason to standard
/// error.
bool try_draw(const std::vector<Plot>& plots, const std::filesystem::path& picture);

}  // namespace palpate::common
