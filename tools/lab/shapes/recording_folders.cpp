#include "tools/lab/shapes/recording_folders.hpp"

#include <algorithm>
#include <string>

#include "rt/config/node.hpp"

namespace palpate::shapes {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> entries(const fs::path& folder) {
  std::vector<fs::path> found;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    found.push_back(entry.path());
  std::sort(found.begin(), found.end());
  return found;
}

void add_files(const fs::path& folder, ShapeFiles& files) {
  for (const fs::path& file : entries(folder)) {
    if (file.extension() == ".yaml") {
      const config::Node node = config::Node::load_file(file.string());
      if (node.has("cases") && node.has("geometry_mm")) files.beams.push_back(file);
      if (node.has("radius_mm") && node.has("length_mm")) files.cylinders.push_back(file);
      continue;
    }
    const std::string name = file.filename().string(), suffix = kFramesSuffix;
    if (name.size() <= suffix.size() ||
        name.compare(name.size() - suffix.size(), suffix.size(), suffix) != 0)
      continue;
    const std::string trial = name.substr(0, name.size() - suffix.size());
    if (fs::exists(folder / (trial + kContourSuffix))) files.sponges.push_back(file);
  }
}

}  // namespace

ShapeFiles find_shapes(const fs::path& folder) {
  ShapeFiles files;
  add_files(folder, files);
  for (const fs::path& entry : entries(folder))
    if (fs::is_directory(entry)) add_files(entry, files);
  return files;
}

}  // namespace palpate::shapes
