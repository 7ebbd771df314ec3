#pragma once

#include <filesystem>
#include <vector>

#include "tools/export/csv_export.hpp"
#include "tools/export/scene_drawing.hpp"

namespace palpate::exporting {

/// Draws the shapes at these times (s since the beginning of the logs), or the last one that tells
/// the quantity where none is given, to `file`; several to names with the time before the ending.
/// Throws std::runtime_error.
std::vector<Written> export_png(ShapeFollower& follower, const DrawingOptions& options,
                                std::vector<double> times, const std::filesystem::path& file);

struct FilmOptions {
  double rate = 25;  // pictures a second of the film
  double speed = 1;  // seconds of the log in a second of the film
};

/// Draws the shapes over time to an .mp4 file. Throws std::runtime_error.
std::vector<Written> export_mp4(ShapeFollower& follower, const DrawingOptions& options,
                                const FilmOptions& film, const std::filesystem::path& file);

}  // namespace palpate::exporting
