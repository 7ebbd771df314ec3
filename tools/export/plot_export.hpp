#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/export/source.hpp"

namespace palpate::exporting {

/// Some numbers of a field of a channel, as a user names them:
///   CHANNEL.field           all of it
///   CHANNEL.field[2]        one number, or one row of an array of two dimensions
///   CHANNEL.field[0][0:3]   a range, the end left out
///   norm(CHANNEL.field...)  the length of the vector of all these numbers
struct FieldPath {
  std::string channel, field;
  std::vector<std::pair<int, int>> ranges;  // by dimension, end left out; those not named: all
  bool is_norm = false;
};

/// Throws std::runtime_error that says what is wrong.
FieldPath parse_field_path(const std::string& text);

/// Draws fields over time, one panel for each of `panels`, which names one path or several with
/// commas between them, to a .png or .svg file. Of more points than a picture can show, the least
/// and the greatest of each piece of time are drawn. Returns the number of curves. Throws
/// std::runtime_error: no such channel, field or index, nothing to draw, no gnuplot.
int export_plot(Source& source, const std::vector<std::string>& panels,
                const std::filesystem::path& picture);

}  // namespace palpate::exporting
