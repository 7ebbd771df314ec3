#pragma once

#include <filesystem>
#include <vector>

#include "tools/export/csv_export.hpp"
#include "tools/export/scene_drawing.hpp"

namespace palpate::exporting {

/// Renders the shapes at these times (s since the start of the logs), or, if none is given, the
/// last one with the quantity, to `file`; several get the time in their names before the extension.
/// Throws std::runtime_error.
std::vector<Written> export_png(ShapeFollower& follower, const DrawingOptions& options,
                                std::vector<double> times, const std::filesystem::path& file);

struct FilmOptions {
  double rate = 25;  // frames per second of the video
  double speed = 1;  // seconds of the log per second of the video
};

/// Renders the shapes over time to an .mp4 file. Throws std::runtime_error.
std::vector<Written> export_mp4(ShapeFollower& follower, const DrawingOptions& options,
                                const FilmOptions& film, const std::filesystem::path& file);

}  // namespace palpate::exporting
