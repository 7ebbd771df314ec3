#pragma once

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>
#include <string>

namespace palpate::support {

inline std::string text_of(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

/// Path of the first curve, which has the first colour and is clipped to its axes, in an SVG of
/// tools/common/plots.py; empty if there is none.
inline std::string first_curve(const std::string& svg) {
  std::smatch found;
  const std::regex curve("<path d=\"([^\"]*)\" clip-path=[^>]*stroke: #0072b2");
  return std::regex_search(svg, found, curve) ? found[1].str() : "";
}

/// Parts of a path that are not connected.
inline auto strokes_of(const std::string& path) {
  return std::count(path.begin(), path.end(), 'M');
}

}  // namespace palpate::support
