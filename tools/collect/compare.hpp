#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <functional>
#include <iosfwd>
#include <string>
#include <vector>

#include "core/sensing/biotac_geometry.hpp"
#include "sim/sensors/sensor_table.hpp"

namespace palpate::collect {

/// Minimum of `cost`, searched from `start` with a simplex of these `steps` (Nelder and Mead 1965)
/// in at most `evaluations`. Needs no derivatives; finds a local minimum. The cost may be infinite.
Eigen::VectorXd minimise(const std::function<double(const Eigen::VectorXd&)>& cost,
                         const Eigen::VectorXd& start, const Eigen::VectorXd& steps,
                         int evaluations);

/// A recording of one contact, tared by its first half second.
struct PressRecording {
  Eigen::VectorXd time;           // s
  Eigen::MatrixXd forces;         // n x 3, N, as the force-torque sensor reads them
  Eigen::MatrixXd changes;        // n x 20 counts: electrodes, then PDC
  sensing::ElectrodeVector rest;  // counts
};

/// `file`: columns t, fx, fy, fz, pdc, e1 to e19. Throws import::CsvError.
PressRecording read_press(const std::filesystem::path& file);

/// Location and kind of a contact in a recording that does not state them.
struct TouchPlace {
  double x = -8e-3, angle = 0.8;  // m along the finger; rad about it, 0 at the centre of the pad
  double radius = 4e-3;           // m
  double length = 8e-3;           // m, extent of the contact along the finger
  double tilt_x = 0, tilt_y = 0;  // rad: angle between mean force and the skin's normal
};

/// Noise-free changes (n x 20 counts) of the emulated finger pressed by the recording's forces.
Eigen::MatrixXd emulate(const PressRecording& recording, const sensors::BiotacTable& table,
                        const TouchPlace& place);

/// Scores of one signal.
struct SignalScore {
  std::string name;
  double correlation = 0;
  double gain_measured = 0, gain_emulated = 0;  // counts/N of |F|
  double rms = 0, rms_own_gain = 0;             // counts; the latter with a fitted gain
  double loop_measured = 0, loop_emulated = 0;  // counts N, relative to |F|; negative: it lags
};

struct Comparison {
  sensors::BiotacTable table;  // with the identified skin and pressure_area
  TouchPlace place;
  std::vector<SignalScore> signals;  // electrodes, then PDC
};

/// Identifies contact point, pressure area and, with `fit_skin`, the skin on the first `part` of
/// the recording and scores the rest. `evaluations`: of the emulation, in the search.
Comparison compare_press(const PressRecording& recording, const sensors::BiotacTable& table,
                         bool fit_skin, double part, int evaluations);

/// Prints the result; the recording is DATA/biotac_foam_bar/ring_finger_dev.csv.
void run_compare(const std::filesystem::path& data, bool fit_skin, double part, int evaluations,
                 std::ostream& out);

}  // namespace palpate::collect
