#include "tools/collect/compare.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <ostream>
#include <vector>

#include "core/math/rigid.hpp"
#include "sim/sensors/biotac.hpp"
#include "tools/common/progress.hpp"
#include "tools/common/table.hpp"
#include "tools/recordings/csv_reader.hpp"

namespace palpate::collect {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using sensing::kElectrodeCount;

constexpr double kTare = 0.5;  // s
constexpr int kSpots = 3;      // point contacts that represent a long one
constexpr int kSignals = kElectrodeCount + 1;
constexpr double kPressureWeight =
    0.3;  // weight of PDC relative to the electrodes, whose changes are smaller

/// Search variables, each of order one: those visible at rest, then those of the hysteresis.
struct Unknowns {
  static constexpr int kPlace = 6, kStatic = 10, kCount = 15;

  static VectorXd from(const TouchPlace& place, const sensors::BiotacTable& table) {
    const sensors::SkinTable& skin = table.skin;
    VectorXd x(kCount);
    x << 100 * place.x, place.angle, std::log(place.radius), 100 * place.length, place.tilt_x,
        place.tilt_y, std::log(skin.foundation), std::log(skin.shear_stiffness),
        std::log(skin.shear_reach), 2 * skin.bulge, 1e5 * skin.friction, 5 * skin.fast_share,
        std::log(skin.fast_time), 5 * skin.slow_share, std::log(skin.slow_time);
    return x;
  }
  static VectorXd steps() {
    VectorXd steps(kCount);
    steps << 0.3, 0.3, 0.4, 0.3, 0.3, 0.3, 0.7, 0.7, 0.5, -0.7, 0.1, 0.2, 0.5, 0.2, 0.5;
    return steps;
  }
  /// False if the values are not feasible.
  static bool to(const VectorXd& x, TouchPlace& place, sensors::BiotacTable& table) {
    sensors::SkinTable& skin = table.skin;
    place = {0.01 * x[0], x[1], std::exp(x[2]), 0.01 * x[3], x[4], x[5]};
    skin.foundation = std::exp(x[6]);
    skin.shear_stiffness = std::exp(x[7]);
    skin.shear_reach = std::exp(x[8]);
    skin.bulge = x[9] / 2;
    skin.friction = 1e-5 * x[10];
    skin.fast_share = x[11] / 5;
    skin.fast_time = std::exp(x[12]);
    skin.slow_share = x[13] / 5;
    skin.slow_time = std::exp(x[14]);
    return within(place.x, -16e-3, 7e-3) && within(place.angle, -1.5, 1.5) &&
           within(place.radius, 1e-3, 10e-3) && within(place.length, 0, 16e-3) &&
           std::hypot(place.tilt_x, place.tilt_y) < 0.8 && within(skin.foundation, 1e6, 1e9) &&
           within(skin.shear_stiffness, 300, 1e5) && within(skin.shear_reach, 3e-3, 0.03) &&
           within(skin.bulge, 0.3, 1) && within(skin.friction, 0, 1e-4) &&
           within(skin.fast_share, 0, 0.3) && within(skin.fast_time, 0.02, 1) &&
           within(skin.slow_share, 0, 0.3) && within(skin.slow_time, 1, 20);
  }

 private:
  static bool within(double x, double lower, double upper) { return x >= lower && x <= upper; }
};

Vector3d point_at(double x, double angle) {
  return sensing::project_on_skin({x, std::sin(angle), -std::cos(angle)});
}

/// Rotation from the force-torque sensor to T: its mean force presses at `place`, up to the tilt.
Eigen::Matrix3d orient(const PressRecording& recording, const TouchPlace& place) {
  const Vector3d mean = recording.forces.colwise().sum().transpose().normalized();
  const Vector3d normal = sensing::skin_normal(point_at(place.x, place.angle));
  const Vector3d along = Vector3d::UnitX();
  const Vector3d axis = place.tilt_x * along + place.tilt_y * along.cross(normal);
  return math::exp_rotation(axis) *
         Eigen::Quaterniond::FromTwoVectors(mean, -normal).toRotationMatrix();
}

double gain_of(const VectorXd& signal, const VectorXd& force) {
  return signal.dot(force) / force.squaredNorm();
}

double correlation_of(const VectorXd& a, const VectorXd& b) {
  const VectorXd x = a.array() - a.mean(), y = b.array() - b.mean();
  const double size = x.norm() * y.norm();
  return size > 0 ? x.dot(y) / size : 0;
}

/// Area between loading and unloading curves relative to a straight line through the origin, since
/// a recording need not return to its start.
double loop_of(const VectorXd& signal, const VectorXd& force) {
  const VectorXd left = signal - gain_of(signal, force) * force;
  double sum = 0;
  for (Index k = 1; k < signal.size(); ++k)
    sum += 0.5 * (left[k] + left[k - 1]) * (force[k] - force[k - 1]);
  return sum;
}

double rms(const VectorXd& x) { return std::sqrt(x.squaredNorm() / static_cast<double>(x.size())); }

/// Every `stride`-th of the first `count` rows.
PressRecording first_rows(const PressRecording& recording, Index count, Index stride) {
  const auto rows = Eigen::seq(0, count - 1, stride);
  return {recording.time(rows), recording.forces(rows, Eigen::all),
          recording.changes(rows, Eigen::all), recording.rest};
}

/// Mean squared error of the changes, with the pressure area that fits PDC best, which `table` then
/// holds: PDC is linear in it.
double misfit(const PressRecording& recording, const TouchPlace& place,
              sensors::BiotacTable& table) {
  MatrixXd emulated = emulate(recording, table, place);
  const double gain =
      gain_of(recording.changes.col(kElectrodeCount), emulated.col(kElectrodeCount));
  if (!(gain > 0)) return std::numeric_limits<double>::infinity();
  table.pressure_area /= gain;
  emulated.col(kElectrodeCount) *= gain;
  const MatrixXd error = emulated - recording.changes;
  return (error.leftCols<kElectrodeCount>().squaredNorm() +
          kPressureWeight * error.col(kElectrodeCount).squaredNorm()) /
         static_cast<double>(recording.time.size());
}

/// The search is local: first the variables visible at rest from several points of the pad, on few
/// rows; then all of them from the best.
Comparison calibrate(const PressRecording& recording, Index rows, const sensors::BiotacTable& table,
                     bool fit_skin, int evaluations) {
  const PressRecording sparse = first_rows(recording, rows, 10);
  const PressRecording dense = first_rows(recording, rows, 1);
  common::Progress progress(1, 1, "calibration on the first rows");
  int count = 0;
  Comparison trial;
  const auto cost = [&](const PressRecording& part, const VectorXd& x) {
    progress.show(static_cast<double>(++count) / evaluations);
    trial.table = table;
    if (!Unknowns::to(x, trial.place, trial.table)) return std::numeric_limits<double>::infinity();
    return misfit(part, trial.place, trial.table);
  };
  constexpr double kXs[] = {-12e-3, -8e-3, -4e-3, 0}, kAngles[] = {-0.8, 0.8};
  const Index at_rest_count = fit_skin ? Unknowns::kStatic : Unknowns::kPlace;
  const Index all_count = fit_skin ? Unknowns::kCount : Unknowns::kPlace;
  const int each = evaluations / 2 / 8;
  VectorXd best;
  double least = std::numeric_limits<double>::infinity();
  for (const double place_x : kXs)
    for (const double angle : kAngles) {
      TouchPlace place;
      place.x = place_x;
      place.angle = angle;
      VectorXd x = Unknowns::from(place, table);
      const auto at_rest = [&](const VectorXd& head) {
        x.head(at_rest_count) = head;
        return cost(sparse, x);
      };
      VectorXd head = x.head(at_rest_count);
      for (int repeat = 0; repeat < 2; ++repeat)  // restart with a new simplex if one has collapsed
        head = minimise(at_rest, head, Unknowns::steps().head(at_rest_count), each / 2);
      const double value = at_rest(head);
      if (value >= least && best.size() > 0) continue;
      least = value;
      best = x;
    }
  VectorXd x = best;
  const auto all = [&](const VectorXd& head) {
    x.head(all_count) = head;
    return cost(dense, x);
  };
  all(minimise(all, best.head(all_count), Unknowns::steps().head(all_count), evaluations / 2));
  progress.finish(true);
  return trial;
}

}  // namespace

VectorXd minimise(const std::function<double(const VectorXd&)>& cost, const VectorXd& start,
                  const VectorXd& steps, int evaluations) {
  struct Corner {
    VectorXd x;
    double cost;
    bool operator<(const Corner& other) const { return cost < other.cost; }
  };
  const auto at = [&](const VectorXd& x) {
    --evaluations;
    return Corner{x, cost(x)};
  };
  std::vector<Corner> corners{at(start)};
  for (Eigen::Index i = 0; i < start.size(); ++i) {
    VectorXd x = start;
    x[i] += steps[i];
    corners.push_back(at(x));
  }
  while (evaluations > 0) {
    std::sort(corners.begin(), corners.end());
    VectorXd centre = VectorXd::Zero(start.size());
    for (std::size_t i = 0; i + 1 < corners.size(); ++i) centre += corners[i].x;
    centre /= static_cast<double>(start.size());
    Corner& worst = corners.back();
    const auto along = [&](double t) { return at(centre + t * (worst.x - centre)); };
    const Corner mirrored = along(-1);
    if (mirrored < corners.front()) {
      worst = std::min(mirrored, along(-2));
    } else if (mirrored < corners[corners.size() - 2]) {
      worst = mirrored;
    } else {
      const Corner inner = along(mirrored < worst ? -0.5 : 0.5);
      if (inner < std::min(mirrored, worst)) {
        worst = inner;
      } else {
        for (std::size_t i = 1; i < corners.size(); ++i)
          corners[i] = at(0.5 * (corners[0].x + corners[i].x));
      }
    }
  }
  return std::min_element(corners.begin(), corners.end())->x;
}

PressRecording read_press(const std::filesystem::path& file) {
  recordings::CsvReader csv(file.string());
  const int time = csv.column("t");
  const int force[] = {csv.column("fx"), csv.column("fy"), csv.column("fz")};
  std::vector<int> columns;
  for (int i = 1; i <= kElectrodeCount; ++i) columns.push_back(csv.column("e" + std::to_string(i)));
  columns.push_back(csv.column("pdc"));
  std::vector<VectorXd> rows;
  while (csv.next()) {
    VectorXd row(4 + kSignals);
    row[0] = csv.number(time);
    for (int i = 0; i < 3; ++i) row[1 + i] = csv.number(force[i]);
    for (int i = 0; i < kSignals; ++i) row[4 + i] = csv.number(columns[i]);
    rows.push_back(row);
  }
  if (rows.size() < 200) csv.fail("fewer than 200 rows: too short to be compared");
  MatrixXd all(static_cast<Index>(rows.size()), 4 + kSignals);
  for (std::size_t k = 0; k < rows.size(); ++k) all.row(static_cast<Index>(k)) = rows[k];
  Index at_rest = 1;
  while (at_rest < all.rows() && all(at_rest, 0) < all(0, 0) + kTare) ++at_rest;
  const Eigen::RowVectorXd mean = all.topRows(at_rest).colwise().mean();
  PressRecording recording;
  recording.time = all.col(0);
  recording.forces = all.middleCols<3>(1).rowwise() - mean.segment<3>(1);
  recording.changes = all.rightCols<kSignals>().rowwise() - mean.tail<kSignals>();
  recording.rest = mean.segment<kElectrodeCount>(4).transpose();
  return recording;
}

MatrixXd emulate(const PressRecording& recording, const sensors::BiotacTable& table,
                 const TouchPlace& place) {
  const Eigen::Matrix3d R_TS = orient(recording, place);
  const int spots = place.length > 0 ? kSpots : 1;
  std::vector<sensors::Touch> touches(spots);
  for (int i = 0; i < spots; ++i) {
    const double offset = spots > 1 ? place.length * (i / (spots - 1.0) - 0.5) : 0;
    touches[i].location_T = point_at(place.x + offset, place.angle);
    touches[i].radius = place.radius;
  }
  sensors::BiotacSkin skin(table.skin);
  MatrixXd changes(recording.time.size(), kSignals);
  for (Index k = 0; k < changes.rows(); ++k) {
    for (sensors::Touch& touch : touches)
      touch.force_T = R_TS * recording.forces.row(k).transpose() / spots;
    skin.step(k == 0 ? 0 : recording.time[k] - recording.time[k - 1], touches);
    const sensing::ElectrodeVector resistance = skin.resistance();
    for (int i = 0; i < kElectrodeCount; ++i)
      changes(k, i) = sensors::electrode_counts(recording.rest[i], resistance[i], table.polarity) -
                      recording.rest[i];
    changes(k, kElectrodeCount) =
        sensors::pressure_counts(sensors::pressing_force(touches) / table.pressure_area);
  }
  return changes;
}

Comparison compare_press(const PressRecording& recording, const sensors::BiotacTable& table,
                         bool fit_skin, double part, int evaluations) {
  const auto first = static_cast<Index>(part * static_cast<double>(recording.time.size()));
  const Index rest = recording.time.size() - first;
  Comparison best = calibrate(recording, first, table, fit_skin, evaluations);
  const MatrixXd emulated = emulate(recording, best.table, best.place);
  const VectorXd force = recording.forces.rowwise().norm();
  for (int i = 0; i < kSignals; ++i) {
    const VectorXd measured = recording.changes.col(i), model = emulated.col(i);
    const VectorXd late = measured.tail(rest), late_model = model.tail(rest);
    const double own = gain_of(measured.head(first), model.head(first));
    SignalScore score;
    score.name = i < kElectrodeCount ? "E" + std::to_string(i + 1) : "PDC";
    score.correlation = correlation_of(late, late_model);
    score.gain_measured = gain_of(late, force.tail(rest));
    score.gain_emulated = gain_of(late_model, force.tail(rest));
    score.rms = rms(late - late_model);
    score.rms_own_gain = rms(late - own * late_model);
    score.loop_measured = loop_of(late, force.tail(rest));
    score.loop_emulated = loop_of(late_model, force.tail(rest));
    best.signals.push_back(score);
  }
  return best;
}

void run_compare(const std::filesystem::path& data, bool fit_skin, double part, int evaluations,
                 std::ostream& out) {
  using common::number;
  const PressRecording recording = read_press(data / "biotac_foam_bar" / "ring_finger_dev.csv");
  const sensors::BiotacTable table =
      sensors::read_sensors(config::Node::from_text("{}", "sensors")).biotac;
  const Comparison found = compare_press(recording, table, fit_skin, part, evaluations);
  common::Table rows({"never seen", "correlation", "counts/N", "emulated", "RMS counts",
                      "with own gain", "loop counts N", "emulated "});
  VectorXd measured(kElectrodeCount), emulated(kElectrodeCount);
  double sum = 0, sum_own = 0;
  for (int i = 0; i < kSignals; ++i) {
    const SignalScore& s = found.signals[i];
    rows.add({s.name, number(s.correlation, 3), number(s.gain_measured, 1),
              number(s.gain_emulated, 1), number(s.rms, 2), number(s.rms_own_gain, 2),
              number(s.loop_measured, 2), number(s.loop_emulated, 2)});
    if (i == kElectrodeCount) break;
    measured[i] = s.gain_measured;
    emulated[i] = s.gain_emulated;
    sum += s.rms * s.rms / kElectrodeCount;
    sum_own += s.rms_own_gain * s.rms_own_gain / kElectrodeCount;
  }
  rows.print(out);
  const auto first = static_cast<Index>(part * static_cast<double>(recording.time.size()));
  const auto late = recording.changes.bottomRows(recording.time.size() - first);
  const double size = std::sqrt(late.leftCols(kElectrodeCount).squaredNorm() /
                                static_cast<double>(late.rows() * kElectrodeCount));
  out << "electrodes: RMS " << number(std::sqrt(sum), 2) << " of " << number(size, 2)
      << " counts, with own gains " << number(std::sqrt(sum_own), 2)
      << "; correlation of the 19 gains " << number(correlation_of(measured, emulated), 3) << "\n";
  const sensors::SkinTable& skin = found.table.skin;
  out << "place: x " << number(1e3 * found.place.x, 1) << " mm, angle "
      << number(found.place.angle, 2) << " rad, radius " << number(1e3 * found.place.radius, 1)
      << " mm, length " << number(1e3 * found.place.length, 1) << " mm, tilt "
      << number(found.place.tilt_x, 2) << " " << number(found.place.tilt_y, 2) << " rad\n"
      << "skin: foundation " << number(1e-6 * skin.foundation, 2) << "e6 N/m^3, shear_stiffness "
      << number(skin.shear_stiffness, 0) << " N/m, shear_reach "
      << number(1e3 * skin.shear_reach, 2) << "e-3 m, bulge " << number(skin.bulge, 3)
      << ", friction " << number(1e6 * skin.friction, 2) << "e-6 m, fast_share "
      << number(skin.fast_share, 3) << ", fast_time " << number(skin.fast_time, 3)
      << " s, slow_share " << number(skin.slow_share, 3) << ", slow_time "
      << number(skin.slow_time, 2) << " s; pressure_area "
      << number(1e4 * found.table.pressure_area, 3) << "e-4 m^2\n";
}

}  // namespace palpate::collect
