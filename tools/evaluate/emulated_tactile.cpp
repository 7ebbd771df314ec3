#include "tools/evaluate/emulated_tactile.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <ostream>
#include <stdexcept>

#include "rt/config/node.hpp"
#include "sim/sensors/biotac.hpp"
#include "tools/evaluate/table.hpp"
#include "tools/evaluate/tactile.hpp"

namespace palpate::evaluate {
namespace {

using sensing::kTactileInputCount;

constexpr double kPeriod = 0.01;      // s, of the readings
constexpr int kStepsPerReading = 10;  // of the skin
constexpr int kRestReadings = 50;
constexpr double kLeastForce = 0.1, kMostForce = 1.5;  // N, along the normal
constexpr double kMostFriction = 0.3;                  // of it, across

sensing::TactileInputs read(sensors::Biotac& biotac, const std::vector<sensors::Touch>& touches) {
  for (int i = 0; i < kStepsPerReading; ++i) biotac.step(kPeriod / kStepsPerReading, touches);
  const sensors::BiotacReading reading = biotac.read();
  sensing::TactileInputs inputs;
  for (int e = 0; e < sensing::kElectrodeCount; ++e) inputs[e] = reading.electrodes[e];
  inputs[sensing::kElectrodeCount] = reading.pac[0];
  inputs[sensing::kElectrodeCount + 1] = reading.pdc;
  return inputs;
}

/// Where a grasp touches: from the tip to 2 mm behind the sphere's centre, up to 30 degrees aside.
sensors::Touch random_touch(math::Random& random) {
  const double aside = random.uniform(-M_PI / 6, M_PI / 6);
  const double tilt = random.uniform(-0.2, 1.2);  // rad, towards the tip; below 0: the cylinder
  const Eigen::Vector3d out(std::max(0.0, std::sin(tilt)), std::cos(tilt) * std::sin(aside),
                            -std::cos(tilt) * std::cos(aside));
  sensors::Touch touch;
  touch.location_T = sensing::kSkinRadius * out;
  touch.location_T.x() += std::min(0.0, tilt) * 1e-2;
  touch.location_T = sensing::project_on_skin(touch.location_T);
  const Eigen::Vector3d normal = sensing::skin_normal(touch.location_T);
  Eigen::Vector3d across(random.normal(), random.normal(), random.normal());
  across -= normal * normal.dot(across);
  const double force = random.uniform(kLeastForce, kMostForce);
  touch.force_T =
      force * (random.uniform(0, kMostFriction) * across.normalized() - normal);  // on the finger
  touch.radius = random.uniform(1.5e-3, 3e-3);
  return touch;
}

void press(sensors::Biotac& biotac, const sensing::TactileInputs& rest, math::Random& random,
           Eigen::MatrixXd& counts, Eigen::MatrixXd& forces) {
  for (Eigen::Index row = 0; row < counts.rows(); ++row) {
    const sensors::Touch touch = random_touch(random);
    sensing::TactileInputs inputs = read(biotac, {touch});
    for (std::uint64_t more = 10 + random.below(40); more > 0; --more)
      inputs = read(biotac, {touch});
    counts.row(row) = (inputs - rest).transpose();
    forces.row(row) = -touch.force_T.transpose();  // on the object
  }
}

double rms_norm(const Eigen::MatrixXd& rows) {
  return std::sqrt(rows.squaredNorm() / static_cast<double>(rows.rows()));
}

}  // namespace

EmulatedTactileScore score_emulated_tactile(std::uint64_t seed, int presses) {
  const sensors::SensorTable table = sensors::read_sensors(config::Node::from_text("{}"));
  sensors::Biotac biotac(table.biotac, kPeriod, math::Random(seed, "biotac"));
  math::Random random(seed, "presses");
  sensing::TactileInputs rest = sensing::TactileInputs::Zero();
  for (int i = 0; i < kRestReadings; ++i) rest += read(biotac, {}) / kRestReadings;

  Eigen::MatrixXd counts(presses, kTactileInputCount), forces(presses, 3);
  press(biotac, rest, random, counts, forces);
  EmulatedTactileScore score;
  score.rows = presses;
  sensing::LinearTactileFitOptions options;
  options.with_offset = false;  // nothing felt shall be no force
  score.fit = sensing::fit_linear_tactile(counts, forces, options);
  const Eigen::RowVectorXd mean = forces.colwise().mean();

  press(biotac, rest, random, counts, forces);
  const Eigen::MatrixXd error = counts * score.fit.model.matrix.transpose() - forces;
  score.test_rms = (error.colwise().squaredNorm().transpose() / presses).cwiseSqrt();
  score.test_rms_norm = rms_norm(error);
  score.mean_rms_norm = rms_norm(forces.rowwise() - mean);
  return score;
}

int run_emulated_tactile(const std::filesystem::path& model, std::ostream& out) {
  const EmulatedTactileScore score = score_emulated_tactile(1, 2000);
  Table table({"emulated BioTac, force error N", "presses", "x", "y", "z", "|F|"});
  const auto row = [&](const char* name, const Eigen::Vector3d& rms) {
    table.add({name, std::to_string(score.rows), number(rms.x(), 3), number(rms.y(), 3),
               number(rms.z(), 3), number(rms.norm(), 3)});
  };
  row("fitted", score.fit.training_rms);
  row("never seen", score.test_rms);
  table.print(out);
  out << "penalty " << score.fit.penalty << "; always the mean: " << number(score.mean_rms_norm, 3)
      << " N\n";
  if (model.empty()) return 0;
  std::ofstream file(model);
  write_tactile_yaml(score.fit.model, file);
  if (!file) throw std::runtime_error(model.string() + ": cannot be written");
  return 0;
}

}  // namespace palpate::evaluate
