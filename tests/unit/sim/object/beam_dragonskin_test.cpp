// A clamped silicone beam measured by others (recording beam_dragonskin): released from straight,
// with and without a weight on its tip. Fitted here: E (statics) and a damping constant.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "sim/object/hyperelastic_plant.hpp"
#include "tests/support/recordings.hpp"

namespace palpate::object {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

const Vector3d kBeamSize(0.1, 0.03, 0.03);
// Markers top, left and right of the tip, standing 6 mm off the surface; the clamp is at x = 0.
const Matrix3d kMarkers =
    (Matrix3d() << 0.1, 0.1, 0.1, 0.015, -0.006, 0.036, 0.036, 0.024, 0.006).finished();

using Table = std::map<std::string, std::vector<std::string>>;

Table read_table(const std::string& name) {
  std::ifstream file(support::recordings() / "beam_dragonskin" / name);
  const auto cells = [](const std::string& line) {
    std::vector<std::string> all;
    std::stringstream stream(line);
    for (std::string cell; std::getline(stream, cell, ',');) all.push_back(cell);
    return all;
  };
  std::string line;
  std::getline(file, line);
  const std::vector<std::string> names = cells(line);
  Table table;
  while (std::getline(file, line)) {
    const std::vector<std::string> row = cells(line);
    for (std::size_t i = 0; i < names.size(); ++i) table[names[i]].push_back(row.at(i));
  }
  return table;
}

double number(const std::string& text) { return std::strtod(text.c_str(), nullptr); }

struct Recording {
  double load = 0;                     // N, down on the upper tip edge
  Matrix3d motion = Matrix3d::Zero();  // of the markers, by column, m
};

std::vector<Recording> read_statics() {
  const Table table = read_table("static_deflection.csv");
  std::vector<Recording> all(table.at("file").size());
  const char* const markers[] = {"tip_top", "tip_left", "tip_right"};
  for (std::size_t i = 0; i < all.size(); ++i) {
    all[i].load = number(table.at("tip_load_N")[i]);
    for (int m = 0; m < 3; ++m)
      for (int axis = 0; axis < 3; ++axis)
        all[i].motion(axis, m) =
            1e-3 * number(table.at(std::string(markers[m]) + "_d" + "xyz"[axis] + "_mm")[i]);
  }
  return all;
}

PlantOptions beam(double young_modulus, const std::array<int, 3>& elements = {6, 2, 2}) {
  PlantOptions options;
  options.size = kBeamSize;
  options.elements = elements;
  options.young_modulus = young_modulus;
  options.poisson_ratio = 0.49;
  options.density = 1070;
  options.gravity_O = {0, 0, -9.81};
  options.clamp = Box{{0, -1, -1}, {0, 1, 1}};
  return options;
}

Vector3d marker(const HyperelasticPlant& plant, int index) {
  const Vector3d place = kMarkers.col(index);
  const Vector3d foot = place.cwiseMax(Vector3d::Zero()).cwiseMin(kBeamSize);
  const Vector3d stand = place - foot;
  int normal = 0;
  stand.cwiseAbs().maxCoeff(&normal);
  const auto tangent = [&](int axis) -> Vector3d {
    const Vector3d step = 1e-4 * Vector3d::Unit(axis);
    return plant.position_at((foot + step).cwiseMin(kBeamSize)) - plant.position_at(foot - step);
  };
  const Vector3d out = tangent((normal + 1) % 3).cross(tangent((normal + 2) % 3)).normalized();
  return plant.position_at(foot) + stand[normal] * out;
}

Matrix3d predict(const PlantOptions& options, double load) {
  HyperelasticPlant plant(options);
  const double share[] = {1.0 / 6, 4.0 / 6, 1.0 / 6};  // shares of an edge's load by its nodes
  const int edges = options.elements[1];
  for (int e = 0; e < edges; ++e) {
    for (int i = 0; i < 3; ++i) {
      const double y = kBeamSize.y() * (e + 0.5 * i) / edges;
      plant.add_force(plant.locate({kBeamSize.x(), y, kBeamSize.z()}),
                      {0, 0, -load * share[i] / edges});
    }
  }
  EXPECT_TRUE(plant.settle(20, 1e-4).converged);
  Matrix3d motion;
  for (int m = 0; m < 3; ++m) motion.col(m) = marker(plant, m) - kMarkers.col(m);
  return motion;
}

/// The modulus that fits the markers' motions best; they are nearly inversely proportional to it.
double fit_modulus(const std::vector<Recording>& recordings) {
  double modulus = 260e3;
  for (int i = 0; i < 3; ++i) {
    std::map<double, Matrix3d> predicted;
    double across = 0, square = 0;
    for (const Recording& r : recordings) {
      if (predicted.count(r.load) == 0) predicted[r.load] = predict(beam(modulus), r.load);
      const Matrix3d& p = predicted.at(r.load);
      across += p.cwiseProduct(r.motion).sum();
      square += p.squaredNorm();
    }
    modulus *= square / across;
  }
  return modulus;
}

struct Oscillation {
  double period = 0;  // s, mean over the first cycles
  double decay = 0;   // 1/s, of the amplitude
};

/// Of a uniformly sampled signal after release, relative to its final value.
Oscillation oscillation(const std::vector<double>& values, double dt, double rest) {
  std::vector<double> crossings, peaks;
  double peak = 0;
  for (std::size_t i = 1; i < values.size() && crossings.size() < 7; ++i) {
    const double last = values[i - 1] - rest, now = values[i] - rest;
    peak = std::max(peak, std::abs(now));
    if (last * now >= 0) continue;
    crossings.push_back(dt * (static_cast<double>(i) - now / (now - last)));
    peaks.push_back(peak);
    peak = 0;
  }
  if (crossings.size() < 7) return {};
  Oscillation result;
  result.period = (crossings[6] - crossings[0]) / 3;
  result.decay = std::log(peaks[1] / peaks[5]) / (2 * result.period);
  return result;
}

TEST(BeamDragonskin, StaticTipIsWithinAMillimetre) {
  PALPATE_REQUIRE_RECORDING("beam_dragonskin/static_deflection.csv");
  const std::vector<Recording> recordings = read_statics();
  ASSERT_EQ(recordings.size(), 3u);
  const double modulus = fit_modulus(recordings);
  std::printf("E %.1f kPa; tip error mm:", 1e-3 * modulus);
  for (const Recording& r : recordings) {
    const Matrix3d errors = predict(beam(modulus), r.load) - r.motion;
    EXPECT_LT(errors.rowwise().mean().norm(), 1e-3);
    std::printf(" %.2f", 1e3 * errors.rowwise().mean().norm());
  }
  std::printf("\n");
}

TEST(BeamDragonskin, FreeOscillationHasTheMeasuredPeriod) {
  PALPATE_REQUIRE_RECORDING("beam_dragonskin/gravity_a.csv");
  const double modulus = fit_modulus(read_statics());
  for (const char* file : {"gravity_a.csv", "gravity_b.csv"}) {
    const Table table = read_table(file);
    std::vector<double> measured;
    double rest = 0;
    for (std::size_t i = 0; i < table.at("t_s").size(); ++i)
      if (number(table.at("t_s")[i]) >= 0)
        measured.push_back(1e-3 * number(table.at("tip_top_z_mm")[i]));
    for (int i = 0; i < 100; ++i) rest += measured[measured.size() - 1 - i] / 100;
    const Oscillation seen = oscillation(measured, 0.01, rest);
    ASSERT_GT(seen.period, 0);

    PlantOptions options = beam(modulus);
    const double settled = kMarkers(2, 0) + predict(options, 0)(2, 0);
    options.mass_damping = 2 * seen.decay;
    HyperelasticPlant plant(options);
    std::vector<double> simulated;
    for (int i = 0; i < 700; ++i) {
      simulated.push_back(marker(plant, 0).z());
      plant.step(1e-3);
    }
    const Oscillation own = oscillation(simulated, 1e-3, settled);
    EXPECT_NEAR(own.period, seen.period, 0.05 * seen.period) << file;
    std::printf("%s: period %.4f s, measured %.4f s; decay %.2f 1/s, measured %.2f 1/s\n", file,
                own.period, seen.period, own.decay, seen.decay);
  }
}

}  // namespace
}  // namespace palpate::object
