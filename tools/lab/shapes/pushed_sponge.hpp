#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

namespace palpate::shapes {

/// A frame of the camera, which looks along the finger's axis. Pixels, y downward.
struct SpongeFrame {
  double time = 0;         // s
  Eigen::Vector2d finger;  // centre of the finger's end
  double force = 0;        // N, of the finger on the sponge, downward
  Eigen::Matrix2Xd outline;
};

/// A trial in which a round finger with a force sensor pushes a sponge down that lies on a table.
struct PushedSponge {
  std::string recording;  // "folder/trial"
  std::vector<SpongeFrame> frames;
  /// Of the sponge at rest, the quadrilateral of lines through its sides: top left, top right,
  /// bottom right, bottom left.
  Eigen::Matrix<double, 2, 4> corners;
  int last_loading = 0;       // index of the frame with the lowest finger
  double contact_height = 0;  // y of the finger where its force sets in, extrapolated to zero

  double length() const;  // pixels
  double height() const;  // pixels
  /// Depth of the finger relative to the sponge's height, negative above it.
  double depth(const SpongeFrame& frame) const;
};

/// `frames`: TRIAL_frames.csv; TRIAL_contour.csv lies next to it. Throws recordings::CsvError.
PushedSponge read_pushed_sponge(const std::filesystem::path& frames);

}  // namespace palpate::shapes
