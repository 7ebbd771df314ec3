#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include "tools/common/output_files.hpp"

namespace palpate::shapes {

inline const char* const kCylinder = R"(length_mm: 100.0
radius_mm: 5.0
axis: z
gravity_m_s2: [0, -9.81, 0]
density_kg_m3: 1000
young_modulus_Pa: 1.0e7
measured_tip_mm: [0, -2, 100]
measured_tip_tolerance_mm: 3.0
)";

/// A camera that looks along -z from 0.5 m before the beam.
inline const char* const kBeam =
    R"(camera: {fx: 900, fy: 900, cx: 640, cy: 360, width: 1280, height: 720}
geometry_mm: {bar: [140, 30, 30], block: [30, 60, 30], clamp_at_rest_x: 0, bar_rest_x: [-140, 0],
  free_block_rest_x: [-170, -140]}
density_kg_m3: 1000
gravity_m_s2: [0, -9.81, 0]
cases:
  first:
    material: Soft
    block_centre_mm: [-155, 0]
    block_rotation_deg: 0
    block_centre_sd_mm: 2
    block_rotation_sd_deg: 1
    camera_R: [[1, 0, 0], [0, -1, 0], [0, 0, -1]]
    camera_t_m: [0.08, 0, 0.5]
)";
inline const char* const kCorners =
    "corner,rest_x_mm,rest_y_mm,rest_z_mm,x_mm,y_mm\n"
    "A,-140,30,15,-140,30\nG,0,15,15,0,15\n";

/// A folder of the test with files of one recording.
class ShapeFolder {
 public:
  std::filesystem::path write(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories((folder_.path() / name).parent_path());
    std::ofstream(folder_.path() / name) << text;
    return folder_.path() / name;
  }
  const std::filesystem::path& path() const { return folder_.path(); }

 private:
  common::TemporaryFolder folder_{"palpate_shapes_"};
};

/// The text with its first `from` replaced; empty if it has none.
inline std::string with(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  return at == std::string::npos ? "" : text.replace(at, from.size(), to);
}

}  // namespace palpate::shapes
