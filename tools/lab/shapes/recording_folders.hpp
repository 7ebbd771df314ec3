#pragma once

#include <filesystem>
#include <vector>

namespace palpate::shapes {

inline constexpr const char* kFramesSuffix = "_frames.csv";
inline constexpr const char* kContourSuffix = "_contour.csv";

/// Files by which recorded shapes are described, by format, each sorted.
struct ShapeFiles {
  std::vector<std::filesystem::path> beams;      // YAML with `cases` and `geometry_mm`
  std::vector<std::filesystem::path> cylinders;  // YAML with `radius_mm` and `length_mm`
  std::vector<std::filesystem::path> sponges;    // TRIAL_frames.csv with TRIAL_contour.csv

  bool empty() const { return beams.empty() && cylinders.empty() && sponges.empty(); }
};

/// Searches a folder and the folders directly below it, whatever the files' own names; other files
/// are ignored. Throws config::Error for a YAML file that cannot be parsed.
ShapeFiles find_shapes(const std::filesystem::path& folder);

}  // namespace palpate::shapes
