#pragma once

#include <array>
#include <filesystem>
#include <ostream>
#include <string>
#include <vector>

#include "tools/lab/cases/case_mesh.hpp"
#include "tools/lab/cases/case_run.hpp"

namespace palpate::cases {

inline constexpr int kBeamMarkers = 3;
inline constexpr const char* kBeamMarkerNames[kBeamMarkers] = {"tip_top", "tip_left", "tip_right"};

/// Displacements of the three markers, columns, m.
using MarkerMotion = Eigen::Matrix<double, 3, kBeamMarkers>;

/// One recording of the silicone beam: the load on the upper edge of its tip, and the displacements
/// of the markers near the tip at rest, relative to the beam held straight.
struct BeamRecording {
  std::string name;
  double tip_load = 0;  // N, down
  MarkerMotion measured;
};

/// `file`: columns file, tip_load_N, <marker>_dx_mm, ..._dy_mm, ..._dz_mm. Throws import::CsvError.
std::vector<BeamRecording> read_beam(const std::filesystem::path& file);

/// The beam model: 100 x 30 x 30 mm of rubber, clamped at x = 0, weight along -z, quadratic
/// elements.
class BeamModel {
 public:
  explicit BeamModel(const CaseGrid& grid);

  /// Positions of the markers at rest. They stand 6 mm off a face and stay perpendicular to it.
  /// Throws std::runtime_error if the static solver does not converge.
  MarkerMotion predict(double young_modulus, double tip_load) const;

  CaseProblem problem(double young_modulus, double tip_load) const;

 private:
  Eigen::Vector3d marker(int index, const Eigen::Matrix3Xd& positions) const;

  CaseProblem rest_;
  Eigen::Matrix3Xd
      unit_load_;  // N at the nodes per 1 N downwards, distributed along the upper tip edge
};

/// One Young's modulus for several recordings, fitted by least squares over all their markers.
struct BeamFit {
  double young_modulus = 0;  // Pa
  std::vector<MarkerMotion>
      errors;  // of every given recording, whether fitted or not: model minus measured
};

/// `left_out`: index of a recording that is predicted but not fitted; -1: none.
BeamFit fit_beam(const BeamModel& model, const std::vector<BeamRecording>& recordings,
                 int left_out = -1);

double tip_error(const MarkerMotion& errors);     // m, length of the mean error of the markers
double marker_error(const MarkerMotion& errors);  // m, maximum over the markers

struct BeamOptions {
  std::filesystem::path data;  // folder of recordings
  CaseGrid grid{{7, 2, 2}, mesh::CellCut::kFive, 2};
  std::filesystem::path json;
};

/// Exit code: 0 if the tip is within 1 mm in every recording on a mesh that sustains 1 kHz.
int run_beam(const BeamOptions& options, std::ostream& out);

}  // namespace palpate::cases
