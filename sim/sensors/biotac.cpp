#include "sim/sensors/biotac.hpp"

#include <algorithm>
#include <cmath>

#include "core/math/constants.hpp"

namespace palpate::sensors {
namespace {

using sensing::kElectrodeCount;

using math::kPi;
constexpr double kPressureStep = 36.5, kVibrationStep = 0.37;  // Pa per count
constexpr double kHighPass = 2 * kPi * 10;                     // rad/s
constexpr double kLeast = 0, kMost = 4095;

std::int16_t counts(double value) {
  return static_cast<std::int16_t>(std::clamp(std::round(value), kLeast, kMost));
}

}  // namespace

double electrode_counts(double rest, double resistance, double polarity) {
  const double other = kMost / rest - 1;  // the divider's fixed resistor
  return polarity > 0 ? kMost * resistance / (resistance + other)
                      : kMost / (1 + other * resistance);
}

double pressure_counts(double pressure) { return pressure / kPressureStep; }

double radius_of(double area) { return std::sqrt(area / kPi); }

Biotac::Biotac(const BiotacTable& table, double period, const math::Random& random)
    : table_(table), period_(period), random_(random), skin_(table.skin) {
  for (double& r : rest_) r = random_.uniform(2600, 3400);
  rest_pressure_ = random_.uniform(1900, 2100);
  rest_temperature_ = random_.uniform(2000, 2400);
}

void Biotac::step(double dt, const std::vector<Touch>& touches) {
  time_ += dt;
  skin_.step(dt, touches);
  pressure_ = pressing_force(touches) / table_.pressure_area;
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
  const sensing::ElectrodeVector resistance = skin_.resistance();
  for (int i = 0; i < kElectrodeCount; ++i)
    reading.electrodes[i] =
        counts(electrode_counts(rest_[i], resistance[i], table_.polarity) +
               table_.warm_up_electrode * cold + noisy(table_.electrode, walk_[i]));
  reading.pdc = counts(rest_pressure_ + pressure_counts(pressure_) +
                       table_.warm_up_pressure * cold + noisy(table_.pressure, pressure_walk_));
  // Distributes the steps since the last reading over the electronics' samples.
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
