#include "tools/collect/bench.hpp"

#include <Eigen/Geometry>
#include <cmath>

#include "sim/sensors/channel.hpp"

namespace palpate::collect {
namespace {

using Eigen::Vector3d;

constexpr double kTick = 1e-3;  // s
constexpr double kMostLean =
    0.1;  // tangential fraction of the force: no probe stands exactly perpendicular

/// Any unit vector perpendicular to `normal`.
Vector3d across(const Vector3d& normal, math::Random& random) {
  Vector3d v(random.normal(), random.normal(), random.normal());
  v -= normal * normal.dot(v);
  return v.normalized();
}

sensors::BiotacTable varied(sensors::BiotacTable table, double deviation, math::Random& random) {
  const auto vary = [&](double& value) { value *= std::exp(deviation * random.normal()); };
  vary(table.skin.foundation);
  vary(table.skin.shear_stiffness);
  vary(table.skin.spread);
  vary(table.pressure_area);
  return table;
}

}  // namespace

std::vector<Sample> Bench::run(const Trial& trial) const {
  const std::string name = "trial" + std::to_string(trial.number);
  math::Random random(seed_, name);
  const sensors::BiotacTable table = varied(table_.biotac, variety_.skin, random);
  const double period = 1 / table.timing.rate;
  sensors::Biotac biotac(table, period, random.split("biotac"));
  const auto& faults = table_.force_torque;
  sensors::Signal force(faults.force, period, faults.bias.head<3>(), random.split("force"));
  sensors::Signal torque(faults.torque, period, faults.bias.tail<3>(), random.split("torque"));

  const Vector3d centre = sensing::project_on_skin(sensing::area_centres().col(trial.area - 1));
  const Vector3d beside = variety_.place * Vector3d(random.normal(), random.normal(), 0);
  const Vector3d at = sensing::project_on_skin(centre + beside);
  const Vector3d normal = sensing::skin_normal(at);
  const Vector3d lean = random.uniform(0, kMostLean) * across(normal, random);
  const Vector3d shear_from = across(normal, random), shear_to = across(normal, random);
  const double phase = random.uniform(0, 2 * M_PI), pace = random.uniform(0.5, 1.5);  // Hz

  std::vector<Sample> samples;
  const auto ticks = std::lround(kTrialTime / kTick);
  const auto ticks_per_sample = std::lround(period / kTick);
  for (long tick = 1; tick <= ticks; ++tick) {
    const double t = static_cast<double>(tick) * kTick;
    const double part = (t - kRest) / (kApproach + kHold);
    const double pressing = trial.profile.force * envelope(t) *
                            (1 + trial.profile.wander * std::sin(2 * M_PI * pace * t + phase));
    const Vector3d sideways =
        lean + trial.profile.shear * ((1 - part) * shear_from + part * shear_to);
    sensors::Touch touch;
    touch.location_T = at;
    touch.force_T = pressing * (sideways - normal);
    touch.radius = contact_radius(trial.probe, pressing, table.skin.foundation);
    biotac.step(kTick, {touch});
    if (tick % ticks_per_sample != 0) continue;
    Sample sample;
    sample.time_us = std::lround(1e6 * t);
    sample.biotac = biotac.read();
    const Vector3d on_probe = -touch.force_T;
    sample.wrench << force.measure(on_probe), torque.measure(at.cross(on_probe));
    samples.push_back(sample);
  }
  return samples;
}

}  // namespace palpate::collect
