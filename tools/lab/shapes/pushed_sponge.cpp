#include "tools/lab/shapes/pushed_sponge.hpp"

#include <algorithm>
#include <limits>

#include "tools/lab/shapes/recording_folders.hpp"
#include "tools/recordings/csv_reader.hpp"

namespace palpate::shapes {

PushedSponge read_pushed_sponge(const std::filesystem::path& frames) {
  const std::string file = frames.filename().string();
  const std::string trial = file.substr(0, file.size() - std::string(kFramesSuffix).size());
  const std::filesystem::path folder = std::filesystem::absolute(frames).parent_path();
  PushedSponge sponge;
  sponge.recording = folder.filename().string() + "/" + trial;
  recordings::CsvReader csv(frames.string());
  csv.require_columns({"frame", "t_s", "finger_x_px", "finger_y_px", "fx_N", "fy_N", "fz_N"});
  double highest = std::numeric_limits<double>::infinity(), lowest = -highest;
  while (csv.next()) {
    const double y = csv.number(csv.column("finger_y_px"));  // downward
    highest = std::min(highest, y);
    lowest = std::max(lowest, y);
    sponge.largest_force = std::max(sponge.largest_force, -csv.number(csv.column("fz_N")));
    ++sponge.frames;
  }
  if (sponge.frames == 0) throw recordings::CsvError(frames.string() + ": has no frame");
  sponge.travel = lowest - highest;
  recordings::CsvReader contour((folder / (trial + kContourSuffix)).string());
  contour.require_columns({"frame", "x_px", "y_px"});
  while (contour.next()) ++sponge.contour_points;
  return sponge;
}

}  // namespace palpate::shapes
