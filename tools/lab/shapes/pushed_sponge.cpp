#include "tools/lab/shapes/pushed_sponge.hpp"

#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <map>

#include "tools/lab/shapes/recording_folders.hpp"
#include "tools/recordings/csv_reader.hpp"

namespace palpate::shapes {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

constexpr double kBand = 0.08;    // of the extent: a side's points lie within it
constexpr double kCorner = 0.12;  // of the extent: points as near to a corner do not count
constexpr double kTouched = 0.1;  // of the largest force: it has set in
constexpr double kLinear = 0.5;   // of the largest force: up to there it rises about linearly

std::vector<SpongeFrame> read_frames(const std::filesystem::path& path,
                                     std::map<int, std::size_t>& index_of) {
  recordings::CsvReader csv(path.string());
  csv.require_columns({"frame", "t_s", "finger_x_px", "finger_y_px", "fz_N"});
  std::vector<SpongeFrame> frames;
  while (csv.next()) {
    SpongeFrame& frame = frames.emplace_back();
    frame.time = csv.number(csv.column("t_s"));
    frame.finger << csv.number(csv.column("finger_x_px")), csv.number(csv.column("finger_y_px"));
    frame.force = -csv.number(csv.column("fz_N"));
    if (frames.size() > 1 && !(frame.time > frames[frames.size() - 2].time))
      csv.fail(csv.column("t_s"), "is not later than in the row before");
    index_of[static_cast<int>(csv.number(csv.column("frame")))] = frames.size() - 1;
  }
  if (frames.empty()) throw recordings::CsvError(path.string() + ": has no frame");
  return frames;
}

void read_outlines(const std::filesystem::path& path, const std::map<int, std::size_t>& index_of,
                   std::vector<SpongeFrame>& frames) {
  recordings::CsvReader csv(path.string());
  csv.require_columns({"frame", "x_px", "y_px"});
  std::vector<std::vector<Vector2d>> points(frames.size());
  while (csv.next()) {
    const auto found = index_of.find(static_cast<int>(csv.number(csv.column("frame"))));
    if (found == index_of.end()) csv.fail(csv.column("frame"), "is not in the file of frames");
    points[found->second].emplace_back(csv.number(csv.column("x_px")),
                                       csv.number(csv.column("y_px")));
  }
  for (std::size_t k = 0; k < frames.size(); ++k) {
    frames[k].outline.resize(2, static_cast<Eigen::Index>(points[k].size()));
    for (std::size_t i = 0; i < points[k].size(); ++i) frames[k].outline.col(i) = points[k][i];
  }
}

/// A line: normal . p = offset.
struct Line {
  Vector2d normal;
  double offset;
};

/// The line through the points near the side `side` (0: least, 1: greatest) of an axis of the
/// outline's bounds, by least squares.
Line side_line(const Eigen::Matrix2Xd& outline, int axis, int side) {
  const Vector2d lower = outline.rowwise().minCoeff(),
                 extent = outline.rowwise().maxCoeff() - lower;
  const int other = 1 - axis;
  std::vector<Vector2d> near;
  for (int i = 0; i < outline.cols(); ++i) {
    const Vector2d at = (outline.col(i) - lower).cwiseQuotient(extent);
    const double across = side == 0 ? at[axis] : 1 - at[axis];
    if (across < kBand && at[other] > kCorner && at[other] < 1 - kCorner)
      near.push_back(outline.col(i));
  }
  Eigen::MatrixX2d along(near.size(), 2);
  Eigen::VectorXd across(near.size());
  for (std::size_t i = 0; i < near.size(); ++i) {
    along.row(i) << 1, near[i][other];
    across[i] = near[i][axis];
  }
  if (near.size() < 2) return {Vector2d::Constant(std::nan("")), 0};
  const Vector2d fit = along.colPivHouseholderQr().solve(across);
  Line line{Vector2d::Unit(axis), fit[0]};
  line.normal[other] = -fit[1];
  return line;
}

Vector2d crossing(const Line& a, const Line& b) {
  Matrix2d normals;
  normals << a.normal.transpose(), b.normal.transpose();
  return normals.inverse() * Vector2d(a.offset, b.offset);
}

Eigen::Matrix<double, 2, 4> corners_of(const Eigen::Matrix2Xd& outline) {
  const Line left = side_line(outline, 0, 0), right = side_line(outline, 0, 1);
  const Line top = side_line(outline, 1, 0), bottom = side_line(outline, 1, 1);
  Eigen::Matrix<double, 2, 4> corners;
  corners << crossing(top, left), crossing(top, right), crossing(bottom, right),
      crossing(bottom, left);
  return corners;
}

/// Where the line through the forces of the loading branch is zero.
double height_of_contact(const PushedSponge& sponge) {
  double largest = 0;
  for (int k = 0; k <= sponge.last_loading; ++k)
    largest = std::max(largest, sponge.frames[k].force);
  std::vector<Vector2d> rising;  // height, force
  for (int k = 0; k <= sponge.last_loading; ++k) {
    const SpongeFrame& frame = sponge.frames[k];
    if (frame.force > kTouched * largest && frame.force < kLinear * largest)
      rising.emplace_back(frame.finger.y(), frame.force);
  }
  if (rising.size() < 2) return std::nan("");
  Eigen::MatrixX2d rows(rising.size(), 2);
  Eigen::VectorXd forces(rising.size());
  for (std::size_t i = 0; i < rising.size(); ++i) {
    rows.row(i) << 1, rising[i].x();
    forces[i] = rising[i].y();
  }
  const Vector2d fit = rows.colPivHouseholderQr().solve(forces);
  return -fit[0] / fit[1];
}

}  // namespace

double PushedSponge::length() const {
  return 0.5 *
         ((corners.col(1) - corners.col(0)).norm() + (corners.col(2) - corners.col(3)).norm());
}

double PushedSponge::height() const {
  return 0.5 *
         ((corners.col(3) - corners.col(0)).norm() + (corners.col(2) - corners.col(1)).norm());
}

double PushedSponge::depth(const SpongeFrame& frame) const {
  return (frame.finger.y() - contact_height) / height();
}

PushedSponge read_pushed_sponge(const std::filesystem::path& frames) {
  const std::string file = frames.filename().string();
  const std::string trial = file.substr(0, file.size() - std::string(kFramesSuffix).size());
  const std::filesystem::path folder = std::filesystem::absolute(frames).parent_path();
  const std::filesystem::path contour = folder / (trial + kContourSuffix);
  PushedSponge sponge;
  sponge.recording = folder.filename().string() + "/" + trial;
  std::map<int, std::size_t> index_of;
  sponge.frames = read_frames(frames, index_of);
  read_outlines(contour, index_of, sponge.frames);
  const Eigen::Matrix2Xd& rest = sponge.frames.front().outline;
  if (rest.cols() > 0) sponge.corners = corners_of(rest);
  if (rest.cols() == 0 || !sponge.corners.allFinite())
    throw recordings::CsvError(
        contour.string() + ": the first frame does not show the four sides of a sponge at rest");
  const auto lowest =
      std::max_element(sponge.frames.begin(), sponge.frames.end(),
                       [](const auto& a, const auto& b) { return a.finger.y() < b.finger.y(); });
  sponge.last_loading = static_cast<int>(lowest - sponge.frames.begin());
  sponge.contact_height = height_of_contact(sponge);
  if (!std::isfinite(sponge.contact_height))
    throw recordings::CsvError(frames.string() + ": no force rises while the finger moves down");
  return sponge;
}

}  // namespace palpate::shapes
