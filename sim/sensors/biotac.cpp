#include "sim/sensors/biotac.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::sensors {
namespace {

using Eigen::Vector3d;
using sensing::ElectrodeVector;
using sensing::kElectrodeCount;

constexpr double kPi = 3.14159265358979323846;
constexpr double kFluidDepth = 1.9e-3;  // m: radius of the skin less that of the core
// Skin as a foundation of springs, N/m^3: half a millimetre for 1.38 N on foam, 5 mm about.
constexpr double kFoundation = 3e7;
constexpr double kSkinSpread = 1.5e-3;   // m: how far the skin carries a point load
constexpr double kShearStiffness = 1e3;  // N/m
constexpr double kShearReach = 10e-3;    // m, about a touch, that the skin shifts with it
// Of the pad: half a cylinder of 15 mm and a quarter of a sphere.
constexpr double kSkinArea =
    kPi * sensing::kSkinRadius * 15e-3 + kPi * sensing::kSkinRadius * sensing::kSkinRadius;  // m^2
constexpr double kLateShare = 0.15, kLateTime = 1.0;           // creep of the skin, s
constexpr double kPressurePerForce = 4.7e3;                    // Pa/N: 177 counts at 1.38 N
constexpr double kPressureStep = 36.5, kVibrationStep = 0.37;  // Pa a count
constexpr double kHighPass = 2 * kPi * 10;                     // rad/s
constexpr double kCountsPerDepth = 250e3;  // 1/m at rest: 126 counts at 1.38 N on foam
constexpr double kLeast = 0, kMost = 4095;

std::int16_t counts(double value) {
  return static_cast<std::int16_t>(std::clamp(std::round(value), kLeast, kMost));
}

/// The point of the skin above an electrode.
Vector3d above(int electrode) {
  const Vector3d p = sensing::electrode_positions().col(electrode);
  return sensing::project_on_skin(p + kFluidDepth * sensing::electrode_normals().col(electrode));
}

double log_depth(double dent) {
  const double left = std::clamp(1 - dent / kFluidDepth, 0.05, 1.5);
  return -kFluidDepth * std::log(left);
}

}  // namespace

double radius_of(double area) { return std::sqrt(area / kPi); }

Biotac::Biotac(const BiotacTable& table, double period, const math::Random& random)
    : table_(table), period_(period), random_(random) {
  for (double& r : rest_) r = random_.uniform(2600, 3400);
  rest_pressure_ = random_.uniform(1900, 2100);
  rest_temperature_ = random_.uniform(2000, 2400);
}

ElectrodeVector Biotac::indentation(const std::vector<Touch>& touches) {
  ElectrodeVector dent = ElectrodeVector::Zero();
  for (const Touch& touch : touches) {
    const Vector3d at = sensing::project_on_skin(touch.location_T);
    const Vector3d normal = sensing::skin_normal(at);
    const double pressing = std::max(0.0, -touch.force_T.dot(normal));
    if (pressing == 0) continue;
    const Vector3d shear = touch.force_T + pressing * normal;
    const Vector3d centre = sensing::project_on_skin(at + shear / kShearStiffness);
    const double variance = 0.5 * touch.radius * touch.radius + kSkinSpread * kSkinSpread;
    const double area = 2 * kPi * variance;
    // Springs that cannot be pressed through.
    const double depth =
        kFluidDepth * (1 - std::exp(-pressing / (kFoundation * area * kFluidDepth)));
    const double bulge = depth * area / kSkinArea;
    for (int i = 0; i < kElectrodeCount; ++i) {
      const Vector3d skin = above(i);
      const double distance2 = (skin - centre).squaredNorm();
      dent[i] += depth * std::exp(-distance2 / (2 * variance)) - bulge;
      // Skin that shifts comes nearer to the core on one side of it and farther on the other.
      dent[i] -= std::exp(-(skin - at).squaredNorm() / (2 * kShearReach * kShearReach)) *
                 sensing::skin_normal(skin).dot(centre - at);
    }
  }
  return dent;
}

void Biotac::step(double dt, const std::vector<Touch>& touches) {
  time_ += dt;
  dent_ = indentation(touches);
  late_ += (1 - std::exp(-dt / kLateTime)) * (dent_ - late_);
  double pressing = 0;
  for (const Touch& touch : touches) {
    const Vector3d normal = sensing::skin_normal(sensing::project_on_skin(touch.location_T));
    pressing += std::max(0.0, -touch.force_T.dot(normal));
  }
  pressure_ = kPressurePerForce * pressing;
  slow_pressure_ += (1 - std::exp(-kHighPass * dt)) * (pressure_ - slow_pressure_);
  vibration_.push_back(pressure_ - slow_pressure_);
}

double Biotac::noisy(const Faults& faults, double& walk) {
  walk += faults.drift * std::sqrt(period_) * random_.normal();
  return walk + faults.noise * random_.normal();
}

BiotacReading Biotac::read() {
  BiotacReading reading;
  const double cold = std::exp(-time_ / table_.warm_up);  // 1 when switched on, 0 when warm
  for (int i = 0; i < kElectrodeCount; ++i) {
    const double dent = (1 - kLateShare) * dent_[i] + kLateShare * late_[i];
    reading.electrodes[i] =
        counts(rest_[i] + table_.polarity * kCountsPerDepth * log_depth(dent) +
               table_.warm_up_electrode * cold + noisy(table_.electrode, walk_[i]));
  }
  reading.pdc = counts(rest_pressure_ + pressure_ / kPressureStep + table_.warm_up_pressure * cold +
                       noisy(table_.pressure, pressure_walk_));
  // The steps since the last reading, as many times as the electronics sample them.
  for (int k = 0; k < kVibrationSamples; ++k) {
    const auto steps = vibration_.size();
    const double value = steps == 0 ? 0 : vibration_[k * steps / kVibrationSamples];
    reading.pac[k] =
        counts(2048 + value / kVibrationStep + noisy(table_.vibration, vibration_walk_));
  }
  vibration_.clear();
  reading.tdc = counts(rest_temperature_ - table_.warm_up_temperature * cold +
                       noisy(table_.temperature, temperature_walk_));
  reading.tac = counts(2048 + table_.warm_up_temperature * cold / table_.warm_up);
  return reading;
}

}  // namespace palpate::sensors
