#include "tools/fit/experiments/beam.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "tools/fit/experiments/beam_model.hpp"
#include "tools/fit/recording.hpp"

namespace palpate::fit {
namespace {

struct Peak {
  double time = 0;
  double size = 0;
};

/// Maximum of the parabola through sample i and its neighbours, uniformly spaced.
Peak top(const Eigen::VectorXd& times, const Eigen::VectorXd& deviation, Eigen::Index i) {
  const double a = deviation[i - 1], b = deviation[i], c = deviation[i + 1];
  const double bend = a - 2 * b + c;
  const double s = bend != 0 ? std::clamp(0.5 * (a - c) / bend, -1.0, 1.0) : 0;
  return {times[i] + s * (times[i + 1] - times[i]), std::abs(b - 0.25 * (a - c) * s)};
}

constexpr double kGravity = 9.81;  // m/s^2

struct Marker {
  std::string name;
  Eigen::Vector3d at;
};

std::vector<Marker> read_markers(const config::Node& node, const config::Key& key) {
  std::vector<Marker> markers;
  for (const config::Node& entry : node.list(key)) {
    markers.push_back({entry.text({"name", "", "its columns are NAME_x, NAME_y, NAME_z"}),
                       entry.vector3({"at", "m", "its place at rest"}, {-10, 10})});
  }
  return markers;
}

std::vector<WantedColumn> wanted_columns(const std::vector<Marker>& markers) {
  std::vector<WantedColumn> wanted = {{"time", Dimension::kTime, "of the sample"}};
  for (const Marker& marker : markers) {
    for (const char* axis : {"_x", "_y", "_z"}) {
      wanted.push_back({marker.name + axis, Dimension::kLength, "of each marker, and _y and _z",
                        true, "MARKER_x"});
    }
  }
  return wanted;
}

/// A recorded time; `otherwise` if it is absent. Throws config::Error.
double read_time(const config::Node& node, const config::Key& key, double least, double most,
                 double otherwise) {
  const double time = optional_quantity(node, key, Dimension::kTime, {}).value_or(otherwise);
  if (!(time >= least && time <= most))
    node.fail(key.name, "is out of range; allowed: " + std::to_string(least) + " to " +
                            std::to_string(most) + " s");
  return time;
}

/// Mean of a column over rows whose time lies in [from, to].
double mean_between(const Recording& recording, const std::string& column, double from, double to) {
  const Eigen::VectorXd& time = recording.column("time");
  const Eigen::VectorXd& values = recording.column(column);
  double sum = 0;
  int count = 0;
  for (Eigen::Index i = 0; i < time.size(); ++i) {
    if (time[i] < from || time[i] > to) continue;
    sum += values[i];
    ++count;
  }
  if (count == 0) {
    recording.fail("no sample between " + std::to_string(from) + " and " + std::to_string(to) +
                   " s: change held_until or rest_from");
  }
  return sum / count;
}

class Beam final : public Experiment {
 public:
  Beam(const config::Node& node, const std::filesystem::path& folder)
      : markers_(read_markers(node, {"markers", "", "near the end, that a camera follows"})) {
    if (markers_.empty()) node.fail("markers", "a beam needs at least one marker");
    std::vector<Marker> all = markers_;
    const std::vector<Marker> on_clamp =
        read_markers(node, {"clamp_markers", "", "on the clamp, which may turn under the load"});
    all.insert(all.end(), on_clamp.begin(), on_clamp.end());
    const Recording recording(node, folder, wanted_columns(all));
    name_ = recording.name();
    recording.require_rows(10);
    recording.require_rising("time");
    recording.require_varying(markers_.front().name + "_z");

    BeamShape shape;
    const config::Node geometry = node.child({"geometry", "", "of the beam at rest"});
    shape.corner = geometry.vector3({"corner", "m", "its lower corner, at the clamp"}, {-10, 10});
    shape.size = geometry.vector3({"size", "m", "of the beam, along x from the clamp"}, {1e-4, 10});
    const std::vector<double> cells =
        geometry.numbers({"cells", "", "of the mesh, along each axis"}, 3, {1, 40});
    for (int k = 0; k < 3; ++k) shape.cells[k] = static_cast<int>(cells[k]);
    const config::Key tip_load{"tip_load", "", "weight at the end"};
    shape.tip_mass = read_quantity(node, tip_load, Dimension::kForce, {0, 1e4}, 0) / kGravity;
    for (const Marker& m : markers_) shape.markers.push_back(m.at);
    for (const Marker& m : on_clamp) shape.clamp_markers.push_back(m.at);

    read_series(node, recording, all);
    read_parameters(node, recording);
    model_ = std::make_unique<BeamModel>(std::move(shape));
  }

  std::string material() const override { return "neo_hookean"; }

  bool predict(const Eigen::VectorXd& parameters, Eigen::VectorXd& prediction,
               Eigen::MatrixXd* jacobian) const override {
    const BeamVector p = parameters;
    BeamPrediction rest, swing;
    if (!model_->at_rest(p, rest) || !model_->swing(p, series_[1].x, step_, swing)) return false;
    prediction.resize(rest.values.size() + swing.values.size());
    prediction << rest.values, swing.values;
    if (jacobian) {
      jacobian->resize(prediction.size(), kBeamParameters);
      *jacobian << rest.slopes, swing.slopes;
    }
    return true;
  }

  /// Largest strain of the clamped section at rest, by the curvature that a weight causes there.
  std::array<double, 2> strain_range() const override { return {-strain_, strain_}; }

  std::vector<Finding> findings(const Eigen::VectorXd& parameters) const override {
    BeamPrediction rest, swing;
    const BeamVector p = parameters;
    if (!model_->at_rest(p, rest) || !model_->swing(p, series_[1].x, step_, swing)) return {};
    const auto count = static_cast<Eigen::Index>(markers_.size());
    Eigen::Vector3d error = Eigen::Vector3d::Zero();
    for (Eigen::Index m = 0; m < count; ++m) {
      error += (rest.values - series_[0].measured).segment<3>(3 * m) / static_cast<double>(count);
    }
    const auto sag = [&](const Eigen::VectorXd& displacements) {
      double sum = 0;
      for (Eigen::Index m = 0; m < count; ++m) sum += displacements[3 * m + 2];
      return sum / static_cast<double>(count);
    };
    const double measured_sag = sag(series_[0].measured), predicted_sag = sag(rest.values);
    const double least = 0.05 * std::abs(measured_sag);
    const Swing seen = measure_swing(series_[1].x, series_[1].measured, measured_sag, least);
    const Swing computed = measure_swing(series_[1].x, swing.values, predicted_sag, least);
    return {{"tip at rest, error", "m", 0, error.norm(), 1e-3},
            {"tip at rest, height", "m", measured_sag, predicted_sag, 1e-3},
            {"period", "s", seen.period, computed.period, 0.05 * seen.period},
            {"decay", "1/s", seen.decay, computed.decay, 0.2 * seen.decay}};
  }

 private:
  void read_series(const config::Node& node, const Recording& recording,
                   const std::vector<Marker>& all) {
    const double end = recording.column("time").maxCoeff();
    const double held =
        read_time(node, {"held_until", "", "then the beam is let go; absent: 0"}, -1e6, end, 0);
    const double rest = read_time(
        node, {"rest_from", "", "it hangs still; absent: the last second"}, held, end, end - 1);
    const config::Node part = node.child({"swing", "", "the oscillation that is fitted"});
    const double from =
        read_time(part, {"from", "", "its start; absent: held_until"}, held, end, held);
    const double to = read_time(part, {"to", "", "its end; absent: the last"}, from, end, end);
    step_ =
        read_quantity(part, {"step", "", "of the integration"}, Dimension::kTime, {1e-5, 1}, 5e-3);
    const config::Node deviations =
        node.child_or_empty({"deviations", "", "standard, of a marker's place"});

    Series at_rest{"rest_displacement", "m", "coordinate", ""};
    at_rest.x.setLinSpaced(static_cast<Eigen::Index>(3 * all.size()), 0,
                           3. * static_cast<double>(all.size()) - 1);
    at_rest.measured.resize(at_rest.x.size());
    at_rest.deviation =
        read_quantity(deviations, {"rest", "", "at rest"}, Dimension::kLength, {1e-9, 1}, 0.5e-3);
    Eigen::Index row = 0;
    for (const Marker& marker : all) {
      for (const char* axis : {"_x", "_y", "_z"}) {
        const std::string column = marker.name + axis;
        at_rest.measured[row++] =
            mean_between(recording, column, rest, end) -
            mean_between(recording, column, recording.column("time").minCoeff(), held);
      }
    }

    Series swing{"swing", "m", "time", "s"};
    swing.deviation = read_quantity(deviations, {"swing", "", "in the oscillation"},
                                    Dimension::kLength, {1e-9, 1}, 1e-3);
    std::vector<double> times, heights;
    const Eigen::VectorXd& time = recording.column("time");
    for (Eigen::Index i = 0; i < time.size(); ++i) {
      if (time[i] < from || time[i] > to) continue;
      double sum = 0;
      for (const Marker& marker : markers_) {
        const std::string column = marker.name + "_z";
        sum += recording.column(column)[i] - mean_between(recording, column, time.minCoeff(), held);
      }
      times.push_back(time[i]);
      heights.push_back(sum / static_cast<double>(markers_.size()));
    }
    if (times.size() < 5) recording.fail("fewer than five samples lie within `swing`: widen it");
    const auto count = static_cast<Eigen::Index>(times.size());
    swing.x = Eigen::Map<Eigen::VectorXd>(times.data(), count);
    swing.measured = Eigen::Map<Eigen::VectorXd>(heights.data(), count);
    series_ = {at_rest, swing};
  }

  void read_parameters(const config::Node& node, const Recording& recording) {
    const config::Node nu =
        node.child_or_empty({"poisson_ratio", "", "between what it is sought; one value: known"});
    const double density = node.number({"density", "kg/m^3", "known, not sought"}, {1, 3e4});
    const double least = nu.number({"from", "", "its least"}, {0, 0.4999}, 0.499);
    const double most = nu.number({"to", "", "its greatest"}, {least, 0.4999}, least);
    const double start = nu.number({"start", "", "of the search"}, {least, most}, least);
    const bool free = node.choice({"clamp", "", "it may turn and shift a little, or not"},
                                  {"rigid", "free"}, "rigid") == "free";
    const double turn = free ? 0.1 : 0, shift = free ? 5e-3 : 0;
    const auto own = [&](const char* what) { return name_ + "." + what; };
    parameters_ = {{"young_modulus", "Pa", 2e5, 1e3, 1e9, true},
                   {"poisson_ratio", "", start, least, most},
                   {"density", "kg/m^3", density, density, density},
                   {"mass_damping", "1/s", 0.5, 0, 100},
                   {"stiffness_damping", "s", 1e-3, 0, 0.1}};
    for (const char* axis : {"x", "y", "z"}) {
      parameters_.push_back({own("clamp_tilt_") + axis, "rad", 0, -turn, turn});
    }
    for (const char* axis : {"x", "y", "z"}) {
      parameters_.push_back({own("clamp_offset_") + axis, "m", 0, -shift, shift});
    }
    const double early = std::max(recording.column("time").minCoeff(), -0.1);
    parameters_.push_back({own("release"), "s", 0, early, 0.1});
    parameters_.push_back({own("held_sag"), "", 0, -0.5, 0.9});
    const Eigen::Vector3d size = node.child("geometry").vector3("size", {1e-4, 10});
    // A slender beam with end displacement w: curvature at the clamp is between 3 w / L^2 (a weight
    // at the tip) and 4 w / L^2 (its own).
    strain_ = 3.5 *
              series_[0]
                  .measured.head(3 * static_cast<Eigen::Index>(markers_.size()))
                  .cwiseAbs()
                  .maxCoeff() /
              (size.x() * size.x()) * size.z() / 2;
  }

  std::vector<Marker> markers_;
  double step_ = 0, strain_ = 0;
  std::unique_ptr<BeamModel> model_;
};

}  // namespace

Swing measure_swing(const Eigen::VectorXd& times, const Eigen::VectorXd& values, double rest,
                    double least) {
  const Eigen::VectorXd deviation = values.array() - rest;
  std::vector<double> passages;
  std::vector<Peak> peaks;  // between zero crossings
  Eigen::Index greatest = -1;
  for (Eigen::Index i = 1; i < times.size(); ++i) {
    if (deviation[i - 1] * deviation[i] <= 0 && deviation[i - 1] != deviation[i]) {
      if (greatest > 0 && !passages.empty()) {
        const Peak peak = top(times, deviation, greatest);
        if (peak.size < least) break;
        peaks.push_back(peak);
      }
      const double share = deviation[i - 1] / (deviation[i - 1] - deviation[i]);
      passages.push_back(times[i - 1] + share * (times[i] - times[i - 1]));
      greatest = -1;
    }
    if (i + 1 < times.size() &&
        (greatest < 0 || std::abs(deviation[i]) > std::abs(deviation[greatest]))) {
      greatest = i;
    }
  }
  Swing swing;
  const std::size_t count = peaks.size();
  if (count < 3) return swing;
  swing.half_periods = static_cast<int>(count);
  swing.period = 2 * (passages[count] - passages[0]) / static_cast<double>(count);
  double time = 0, level = 0, squares = 0, product = 0;
  for (const Peak& p : peaks) {
    time += p.time / static_cast<double>(count);
    level += std::log(p.size) / static_cast<double>(count);
  }
  for (const Peak& p : peaks) {
    squares += (p.time - time) * (p.time - time);
    product += (p.time - time) * (std::log(p.size) - level);
  }
  swing.decay = -product / squares;
  return swing;
}

std::unique_ptr<Experiment> make_beam(const config::Node& node,
                                      const std::filesystem::path& folder) {
  return std::make_unique<Beam>(node, folder);
}

}  // namespace palpate::fit
