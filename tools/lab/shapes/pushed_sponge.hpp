#pragma once

#include <filesystem>
#include <string>

namespace palpate::shapes {

/// What a trial holds in which a finger with a force sensor pushes a sponge on a table.
struct PushedSponge {
  std::string recording;     // "folder/trial"
  int frames = 0;            // with finger and force
  int contour_points = 0;    // of all frames together
  double travel = 0;         // pixels, of the finger, downward
  double largest_force = 0;  // N, of the finger on the sponge, downward
};

/// `frames`: TRIAL_frames.csv; TRIAL_contour.csv lies next to it. Throws recordings::CsvError.
PushedSponge read_pushed_sponge(const std::filesystem::path& frames);

}  // namespace palpate::shapes
