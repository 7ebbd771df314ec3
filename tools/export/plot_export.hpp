#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/export/source.hpp"

namespace palpate::exporting {

/// A selection of numbers of a field of a channel, in the user's notation:
///    CHANNEL.field           all of it
///    CHANNEL.field[2]        one number, or one row of a two-dimensional array
///    CHANNEL.field[0][0:3]   a range, without its end
///    norm(CHANNEL.field...)  the norm of the vector of all these numbers
struct FieldPath {
  std::string channel, field;
  std::vector<std::pair<int, int>>
      ranges;  // by dimension, end exclusive; dimensions not named: all
  bool is_norm = false;
};

/// Throws std::runtime_error with the reason.
FieldPath parse_field_path(const std::string& text);

/// Plots fields over time, one panel for each of `panels`, which names one path or several
/// separated by commas, to a .png or .svg file. If there are more points than an image can show,
/// the minimum and maximum of each time interval are drawn. Returns the number of curves. Throws
/// std::runtime_error: no such channel, field or index, nothing to draw, no matplotlib.
int export_plot(Source& source, const std::vector<std::string>& panels,
                const std::filesystem::path& picture);

}  // namespace palpate::exporting
