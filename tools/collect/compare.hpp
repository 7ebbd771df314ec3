#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

#include "core/sensing/biotac_geometry.hpp"
#include "sim/sensors/sensor_table.hpp"

namespace palpate::collect {

/// What a recording of one touch says, tared by its first half second.
struct PressRecording {
  Eigen::VectorXd time;           // s
  Eigen::MatrixXd forces;         // n x 3, N, as the force-torque sensor reads them
  Eigen::MatrixXd changes;        // n x 20 counts: electrodes, then PDC
  sensing::ElectrodeVector rest;  // counts
};

/// `file`: columns t, fx, fy, fz, pdc, e1 to e19. Throws import::CsvError.
PressRecording read_press(const std::filesystem::path& file);

/// Where and how one finger is touched in a recording that does not say so.
struct TouchPlace {
  double x = -8e-3, angle = 0.8;  // m along the finger; rad about it, 0 in the middle of the pad
  double radius = 4e-3;           // m
  double length = 8e-3;           // m, of the touch along the finger
  double tilt_x = 0, tilt_y = 0;  // rad: of the mean force beside the skin's normal
};

/// Changes (n x 20 counts) that the emulated finger gives, without noise, when pressed by the
/// recording's forces.
Eigen::MatrixXd emulate(const PressRecording& recording, const sensors::BiotacTable& table,
                        const TouchPlace& place);

/// Of one signal.
struct SignalScore {
  std::string name;
  double correlation = 0;
  double gain_measured = 0, gain_emulated = 0;  // counts/N of |F|
  double rms = 0, rms_own_gain = 0;             // counts; the latter with a gain of its own
  double loop_measured = 0, loop_emulated = 0;  // counts N, over |F|; below zero: it stays behind
};

struct Comparison {
  sensors::BiotacTable table;  // with skin and pressure_area as found
  TouchPlace place;
  std::vector<SignalScore> signals;  // electrodes, then PDC
};

/// Finds place, pressure area and, with `fit_skin`, the skin on the first `part` of the recording
/// and scores the rest.
/// `evaluations`: of the emulation, in the search.
Comparison compare_press(const PressRecording& recording, const sensors::BiotacTable& table,
                         bool fit_skin, double part, int evaluations);

/// Prints it all; the recording is DATA/biotac_foam_bar/ring_finger_dev.csv.
void run_compare(const std::filesystem::path& data, bool fit_skin, double part, int evaluations,
                 std::ostream& out);

}  // namespace palpate::collect
