#include "tools/lab/sensor_models/emulated_tactile.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <ostream>
#include <stdexcept>

#include "rt/config/node.hpp"
#include "sim/sensors/biotac.hpp"
#include "tools/common/table.hpp"
#include "tools/lab/sensor_models/tactile.hpp"

namespace palpate::sensor_models {
namespace {

using sensing::kTactileInputCount;

constexpr double kPeriod = 0.01;      // s, of the readings
constexpr int kStepsPerReading = 10;  // of the skin
constexpr int kRestReadings = 50;
constexpr double kLeastForce = 0.05, kMostForce = 2;  // N, along the normal
constexpr double kMostFriction = 0.6;                 // fraction of it, tangential

sensing::TactileInputs read(sensors::Biotac& biotac, const std::vector<sensors::Touch>& touches) {
  for (int i = 0; i < kStepsPerReading; ++i) biotac.step(kPeriod / kStepsPerReading, touches);
  const sensors::BiotacReading reading = biotac.read();
  sensing::TactileInputs inputs;
  for (int e = 0; e < sensing::kElectrodeCount; ++e) inputs[e] = reading.electrodes[e];
  inputs[sensing::kElectrodeCount] = reading.pac[0];
  inputs[sensing::kElectrodeCount + 1] = reading.pdc;
  return inputs;
}

/// Contact region of a grasp: the pad up to the tip and 7 mm along the cylinder, up to 45 degrees
/// to the side.
sensors::Touch random_touch(math::Random& random) {
  const double aside = random.uniform(-M_PI / 4, M_PI / 4);
  const double along = random.uniform(-1, 1.5);  // above 0: rad towards the tip; below: 7 mm
  const double tilt = std::max(0.0, along);
  sensors::Touch touch;
  touch.location_T = sensing::kSkinRadius * Eigen::Vector3d(std::sin(tilt) + std::min(0.0, along),
                                                            std::cos(tilt) * std::sin(aside),
                                                            -std::cos(tilt) * std::cos(aside));
  const Eigen::Vector3d normal = sensing::skin_normal(touch.location_T);
  Eigen::Vector3d across(random.normal(), random.normal(), random.normal());
  across -= normal * normal.dot(across);
  const double force = random.uniform(kLeastForce, kMostForce);
  touch.force_T =
      force * (random.uniform(0, kMostFriction) * across.normalized() - normal);  // on the finger
  touch.radius = random.uniform(1.5e-3, 3e-3);
  return touch;
}

struct Presses {
  explicit Presses(int count)
      : counts(count, kTactileInputCount), forces(count, 3), places(count, 3) {}
  Eigen::MatrixXd counts, forces, places;
};

void press(sensors::Biotac& biotac, const sensing::TactileInputs& rest, math::Random& random,
           Presses& presses) {
  for (Eigen::Index row = 0; row < presses.counts.rows(); ++row) {
    const sensors::Touch touch = random_touch(random);
    sensing::TactileInputs inputs = read(biotac, {touch});
    for (std::uint64_t more = 10 + random.below(40); more > 0; --more)
      inputs = read(biotac, {touch});
    presses.counts.row(row) = (inputs - rest).transpose();
    presses.forces.row(row) = -touch.force_T.transpose();  // on the object
    presses.places.row(row) = touch.location_T.transpose();
  }
}

double rms_norm(const Eigen::MatrixXd& rows) {
  return std::sqrt(rows.squaredNorm() / static_cast<double>(rows.rows()));
}

}  // namespace

EmulatedTactileScore score_emulated_tactile(std::uint64_t seed, int presses,
                                            sensing::TactileFeatures features) {
  const sensors::SensorTable table = sensors::read_sensors(config::Node::from_text("{}"));
  sensors::Biotac biotac(table.biotac, kPeriod, math::Random(seed, "biotac"));
  math::Random random(seed, "presses");
  sensing::TactileInputs rest = sensing::TactileInputs::Zero();
  for (int i = 0; i < kRestReadings; ++i) rest += read(biotac, {}) / kRestReadings;

  Presses fitted(presses), unseen(presses);
  press(biotac, rest, random, fitted);
  press(biotac, rest, random, unseen);
  EmulatedTactileScore score;
  score.rows = presses;
  sensing::LinearTactileFitOptions options;
  options.with_offset = false;  // no contact must give zero force
  options.features = features;
  score.fit = sensing::fit_linear_tactile(fitted.counts, fitted.forces, options);
  sensing::fit_tactile_place(fitted.counts, fitted.places, options, score.fit.model);

  Eigen::MatrixXd error(presses, 3), place_error(presses, 3), centroid_error(presses, 3);
  for (int i = 0; i < presses; ++i) {
    const sensing::TactileInputs inputs = unseen.counts.row(i).transpose();
    error.row(i) = score.fit.model.force(inputs).transpose() - unseen.forces.row(i);
    place_error.row(i) = score.fit.model.location(inputs).transpose() - unseen.places.row(i);
    centroid_error.row(i) =
        sensing::locate_contact(inputs.head<sensing::kElectrodeCount>(), {}).location.transpose() -
        unseen.places.row(i);
  }
  score.test_rms = (error.colwise().squaredNorm().transpose() / presses).cwiseSqrt();
  score.test_rms_norm = rms_norm(error);
  score.place_rms = rms_norm(place_error);
  score.centroid_rms = rms_norm(centroid_error);
  const Eigen::RowVectorXd mean = fitted.forces.colwise().mean();
  score.mean_rms_norm = rms_norm(unseen.forces.rowwise() - mean);
  return score;
}

int run_emulated_tactile(const std::filesystem::path& model, std::ostream& out) {
  const int presses = 3000;
  common::Table table(
      {"emulated BioTac", "presses", "force error N: x", "y", "z", "|F|", "place mm"});
  EmulatedTactileScore score;
  for (const auto features :
       {sensing::TactileFeatures::kCounts, sensing::TactileFeatures::kProducts}) {
    score = score_emulated_tactile(1, presses, features);
    const std::string name =
        features == sensing::TactileFeatures::kCounts ? "linear" : "with products";
    const auto row = [&](const std::string& part, const Eigen::Vector3d& rms,
                         const std::string& place) {
      table.add({name + part, std::to_string(score.rows), common::number(rms.x(), 3),
                 common::number(rms.y(), 3), common::number(rms.z(), 3),
                 common::number(rms.norm(), 3), place});
    };
    row(", fitted", score.fit.training_rms, "");
    row(", never seen", score.test_rms, common::number(1e3 * score.place_rms, 2));
  }
  table.print(out);
  out << "always the mean: " << common::number(score.mean_rms_norm, 3)
      << " N; place by the centroid: " << common::number(1e3 * score.centroid_rms, 2) << " mm\n";
  if (model.empty()) return 0;
  std::ofstream file(model);
  write_tactile_yaml(score.fit.model, file);
  if (!file) throw std::runtime_error(model.string() + ": cannot be written");
  return 0;
}

}  // namespace palpate::sensor_models
