#include "tools/lab/shapes/hanging_beam.hpp"

#include <cmath>

#include "core/math/constants.hpp"
#include "rt/config/node.hpp"
#include "tools/lab/shapes/shape_score.hpp"
#include "tools/recordings/csv_reader.hpp"

namespace palpate::shapes {
namespace {

namespace fs = std::filesystem;
using config::Node;
using config::Range;
using Eigen::Vector2d;
using Eigen::Vector3d;
using math::kDegree;

constexpr Range kPlace{-1e6, 1e6};  // mm
constexpr Range kSize{1e-3, 1e6};   // mm

// Standard deviations of points on an edge, mm, which the recording's description gives but its
// YAML file need not: the second where the camera looks obliquely.
constexpr double kEdgeDeviation = 1.5, kObliqueEdgeDeviation = 3;
constexpr double kOblique = 35 * kDegree;

Eigen::AlignedBox3d read_box(const Node& geometry, const std::string& size,
                             const std::string& range) {
  const std::vector<double> s = geometry.numbers(size, 3, kSize);
  const std::vector<double> x = geometry.numbers(range, 2, kPlace);
  if (std::abs(x[1] - x[0] - s[0]) > 1e-6) geometry.fail(range, "is not as long as " + size);
  return {kMm * Vector3d(x[0], -s[1] / 2, -s[2] / 2), kMm * Vector3d(x[1], s[1] / 2, s[2] / 2)};
}

PinholeCamera read_camera(const Node& intrinsic, const Node& c) {
  PinholeCamera camera;
  constexpr Range kPixels{1, 1e5};
  camera.focal = {intrinsic.number("fx", kPixels), intrinsic.number("fy", kPixels)};
  camera.centre = {intrinsic.number("cx", {-1e5, 1e5}), intrinsic.number("cy", {-1e5, 1e5})};
  camera.width = intrinsic.integer("width", kPixels);
  camera.height = intrinsic.integer("height", kPixels);
  const std::string distortion = intrinsic.text("distortion", "none");
  if (distortion != "none") intrinsic.fail("distortion", "is not known; allowed: none");
  const std::vector<Vector3d> rows = c.points("camera_R");
  if (rows.size() != 3) c.fail("camera_R", "must have three rows");
  for (int r = 0; r < 3; ++r) camera.rotation.row(r) = rows[r].transpose();
  if (!(camera.rotation * camera.rotation.transpose()).isIdentity(1e-3) ||
      camera.rotation.determinant() < 0)
    c.fail("camera_R", "is no rotation");
  camera.translation = c.vector3("camera_t_m", {-1e3, 1e3});
  return camera;
}

std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string::npos) return "";
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

void read_parts(const Node& c, const HangingBeams& beams, BeamCase& read) {
  const std::string material = c.text("material");
  const double free = beams.block.min().x(), clamp = beams.bar.max().x();
  const auto plus = material.find('+');
  if (plus == std::string::npos) {
    read.parts = {{trimmed(material), free, clamp}};
    return;
  }
  const std::string first = trimmed(material.substr(0, plus)),
                    second = trimmed(material.substr(plus + 1));
  if (first.empty() || second.empty() || second.find('+') != std::string::npos)
    c.fail("material", "must be one name, or two joined by a plus sign, that at the clamp first");
  read.is_interface_assumed = !c.has("interface_rest_x_mm");
  const double middle = beams.bar.center().x();
  const double border =
      kMm * c.number("interface_rest_x_mm", {free / kMm, clamp / kMm}, middle / kMm);
  read.parts = {{first, border, clamp}, {second, free, border}};
}

std::vector<BeamCorner> read_corners(const fs::path& file) {
  recordings::CsvReader csv(file.string());
  csv.require_columns({"corner", "rest_x_mm", "rest_y_mm", "rest_z_mm", "x_mm", "y_mm"});
  const auto at = [&csv](const char* column) { return kMm * csv.number(csv.column(column)); };
  std::vector<BeamCorner> corners;
  while (csv.next())
    corners.push_back({csv.text(csv.column("corner")),
                       {at("rest_x_mm"), at("rest_y_mm"), at("rest_z_mm")},
                       {at("x_mm"), at("y_mm")}});
  return corners;
}

/// Points of a file; none where it is absent and was not named.
Eigen::Matrix2Xd read_points(const Node& c, const std::string& key, const fs::path& usual,
                             const char* x, const char* y, double unit) {
  const bool is_named = c.has(key);
  const fs::path file = is_named ? fs::path(c.path(key)) : usual;
  if (!is_named && !fs::exists(file)) return {};
  recordings::CsvReader csv(file.string());
  csv.require_columns({x, y});
  std::vector<Vector2d> points;
  while (csv.next())
    points.push_back(unit * Vector2d(csv.number(csv.column(x)), csv.number(csv.column(y))));
  if (points.size() < 2) throw recordings::CsvError(file.string() + ": has fewer than two points");
  Eigen::Matrix2Xd matrix(2, points.size());
  for (std::size_t i = 0; i < points.size(); ++i) matrix.col(i) = points[i];
  return matrix;
}

BeamCase read_case(const Node& c, const Node& intrinsic, const std::string& name,
                   const fs::path& folder, const HangingBeams& beams) {
  BeamCase read;
  read.name = name;
  read.recording = folder.filename().string() + "/" + name;
  read_parts(c, beams, read);
  const std::vector<double> centre = c.numbers("block_centre_mm", 2, kPlace);
  read.centre = kMm * Vector2d(centre[0], centre[1]);
  read.rotation = kDegree * c.number("block_rotation_deg", {-180, 180});
  constexpr Range kDeviation{1e-6, 1e3};
  read.centre_deviation = kMm * c.number("block_centre_sd_mm", kDeviation);
  read.rotation_deviation = kDegree * c.number("block_rotation_sd_deg", kDeviation);
  read.outline_deviation = c.number("fit_rms_px", kDeviation, 1);
  read.camera = read_camera(intrinsic, c);
  const bool is_oblique = read.camera.obliquity() > kOblique;
  read.edge_deviation =
      kMm * c.number("edge_sd_mm", kDeviation, is_oblique ? kObliqueEdgeDeviation : kEdgeDeviation);
  read.corners = read_corners(c.has("corners") ? fs::path(c.path("corners"))
                                               : folder / (name + "_corners.csv"));
  read.lower_edge =
      read_points(c, "lower_edge", folder / (name + "_lower_edge.csv"), "x_mm", "y_mm", kMm);
  read.silhouette =
      read_points(c, "silhouette", folder / (name + "_silhouette_px.csv"), "u_px", "v_px", 1);
  return read;
}

}  // namespace

HangingBeams read_hanging_beams(const fs::path& file, const std::vector<std::string>& overrides) {
  const Node root = Node::load_file(file.string(), overrides);
  const Node geometry = root.child("geometry_mm");
  HangingBeams beams;
  beams.bar = read_box(geometry, "bar", "bar_rest_x");
  beams.block = read_box(geometry, "block", "free_block_rest_x");
  const double clamp = geometry.number("clamp_at_rest_x", kPlace);
  if (std::abs(kMm * clamp - beams.bar.max().x()) > 1e-9)
    geometry.fail("clamp_at_rest_x", "is not the upper end of bar_rest_x");
  if (std::abs(beams.block.max().x() - beams.bar.min().x()) > 1e-9)
    geometry.fail("free_block_rest_x", "does not begin where the bar ends");
  beams.density = root.number("density_kg_m3", {1e-3, 1e5});
  beams.gravity = root.vector3("gravity_m_s2", {-100, 100});
  const Node cases = root.child("cases"), intrinsic = root.child("camera");
  const fs::path folder = fs::absolute(file).parent_path();
  for (const std::string& name : cases.keys())
    beams.cases.push_back(read_case(cases.child(name), intrinsic, name, folder, beams));
  if (beams.cases.empty()) root.fail("cases", "is empty");
  return beams;
}

}  // namespace palpate::shapes
