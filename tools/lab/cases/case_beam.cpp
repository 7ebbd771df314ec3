#include "tools/lab/cases/case_beam.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>

#include "core/mesh/point_locator.hpp"
#include "tools/common/output_files.hpp"
#include "tools/common/table.hpp"
#include "tools/recordings/csv_reader.hpp"

namespace palpate::cases {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using nlohmann::json;

constexpr double kMm = 1e-3;
constexpr double kGoal = 1e-3;    // m, of the tip
constexpr double kBudget = 1000;  // us, of a tick
const Vector3d kSize(0.1, 0.03, 0.03);
// Nominal marker positions in the beam's frame, whose x = 0 is the tip; in the model the clamp is
// at x = 0.
const MarkerMotion kMarkers =
    (MarkerMotion() << 0.1, 0.1, 0.1, 0.015, -0.006, 0.036, 0.036, 0.024, 0.006).finished();

CaseFile beam_case() {
  CaseFile c;
  c.name = "beam_dragonskin";
  c.boxes = {{Vector3d::Zero(), kSize}};
  c.fixed = CaseRegion{"fixed", {Vector3d::Zero(), Vector3d(0, kSize.y(), kSize.z())}};
  c.material = {260e3, 0.499, 1070};
  c.gravity = {0, 0, -9.81};
  return c;
}

/// Nodal shares of a load distributed uniformly along the straight edge x, z of the body.
Eigen::VectorXd edge_shares(const mesh::ElementMesh& mesh, double x, double z) {
  const auto on_edge = [&](int node) {
    return std::abs(mesh.nodes(0, node) - x) < 1e-9 && std::abs(mesh.nodes(2, node) - z) < 1e-9;
  };
  Eigen::VectorXd shares = Eigen::VectorXd::Zero(mesh.node_count());
  std::set<int> done;  // midside nodes
  for (int e = 0; e < mesh.element_count(); ++e) {
    for (int m = 0; m < 6; ++m) {
      const auto& ends = mesh::kTetrahedronEdges[m];
      const int a = mesh.elements(ends[0], e), b = mesh.elements(ends[1], e);
      const int middle = mesh.elements(4 + m, e);
      if (!on_edge(a) || !on_edge(b) || !done.insert(middle).second) continue;
      const double length = (mesh.nodes.col(a) - mesh.nodes.col(b)).norm();
      shares[a] += length / 6;
      shares[b] += length / 6;
      shares[middle] += length * 4 / 6;
    }
  }
  return shares / shares.sum();
}

std::map<double, MarkerMotion> predictions(const BeamModel& model, double young_modulus,
                                           const std::vector<BeamRecording>& recordings) {
  std::map<double, MarkerMotion> all;
  for (const BeamRecording& r : recordings)
    if (all.count(r.tip_load) == 0) all[r.tip_load] = model.predict(young_modulus, r.tip_load);
  return all;
}

/// Minimum of a unimodal function between `lower` and `upper`, by golden section.
template <class Function>
double minimise(double lower, double upper, double tolerance, const Function& f) {
  const double golden = (std::sqrt(5.0) - 1) / 2;
  double a = upper - golden * (upper - lower), b = lower + golden * (upper - lower);
  double at_a = f(a), at_b = f(b);
  while (upper - lower > tolerance) {
    if (at_a < at_b) {
      upper = b;
      b = a;
      at_b = at_a;
      at_a = f(a = upper - golden * (upper - lower));
    } else {
      lower = a;
      a = b;
      at_a = at_b;
      at_b = f(b = lower + golden * (upper - lower));
    }
  }
  return (lower + upper) / 2;
}

json to_json(const BeamRecording& recording, const MarkerMotion& errors) {
  json j{{"recording", recording.name},
         {"tip_load_N", recording.tip_load},
         {"tip_error_m", tip_error(errors)}};
  for (int m = 0; m < kBeamMarkers; ++m)
    j["marker_error_m"][kBeamMarkerNames[m]] = errors.col(m).norm();
  return j;
}

}  // namespace

std::vector<BeamRecording> read_beam(const std::filesystem::path& file) {
  recordings::CsvReader csv(file.string());
  std::vector<BeamRecording> recordings;
  while (csv.next()) {
    BeamRecording recording;
    recording.name = csv.text(csv.column("file"));
    recording.tip_load = csv.number(csv.column("tip_load_N"));
    for (int m = 0; m < kBeamMarkers; ++m)
      for (int axis = 0; axis < 3; ++axis)
        recording.measured(axis, m) =
            kMm *
            csv.number(csv.column(std::string(kBeamMarkerNames[m]) + "_d" + "xyz"[axis] + "_mm"));
    recordings.push_back(std::move(recording));
  }
  return recordings;
}

BeamModel::BeamModel(const CaseGrid& grid) {
  const CaseFile c = beam_case();
  rest_ = make_problem(c, make_case_mesh(c, grid), mesh::ElementOrder::kQuadratic);
  unit_load_ = Vector3d(0, 0, -1) * edge_shares(rest_.body.mesh, kSize.x(), kSize.z()).transpose();
}

CaseProblem BeamModel::problem(double young_modulus, double tip_load) const {
  CaseProblem problem = rest_;
  problem.body.material.young_modulus = young_modulus;
  problem.loads = tip_load * unit_load_;
  return problem;
}

Vector3d BeamModel::marker(int index, const Matrix3Xd& positions) const {
  const Vector3d place = kMarkers.col(index);
  const Vector3d foot = place.cwiseMax(Vector3d::Zero()).cwiseMin(kSize);
  const Vector3d stand = place - foot;
  const mesh::PointLocator locator(rest_.body.mesh);
  int normal = 0;
  stand.cwiseAbs().maxCoeff(&normal);
  const auto tangent = [&](int axis) -> Vector3d {
    constexpr double kStep = 1e-4;  // m
    const Vector3d step = kStep * Vector3d::Unit(axis);
    const Vector3d ahead = (foot + step).cwiseMin(kSize);
    const Vector3d behind = (foot - step).cwiseMax(Vector3d::Zero());
    return locator.locate(ahead).interpolate(positions) -
           locator.locate(behind).interpolate(positions);
  };
  const Vector3d upright = tangent((normal + 1) % 3).cross(tangent((normal + 2) % 3)).normalized();
  return locator.locate(foot).interpolate(positions) + stand[normal] * upright;
}

MarkerMotion BeamModel::predict(double young_modulus, double tip_load) const {
  const elasticity::StaticSolution s = solve(problem(young_modulus, tip_load));
  if (!s.converged) throw std::runtime_error("the beam's equilibrium was not found");
  MarkerMotion motion;
  for (int m = 0; m < kBeamMarkers; ++m)
    motion.col(m) = marker(m, s.positions) - marker(m, rest_.body.mesh.nodes);
  return motion;
}

BeamFit fit_beam(const BeamModel& model, const std::vector<BeamRecording>& recordings,
                 int left_out) {
  std::vector<BeamRecording> used = recordings;
  if (left_out >= 0) used.erase(used.begin() + left_out);
  const double log_modulus = minimise(std::log(1e5), std::log(1e6), 1e-4, [&](double log_e) {
    const auto predicted = predictions(model, std::exp(log_e), used);
    double sum = 0;
    for (const BeamRecording& r : used)
      sum += (predicted.at(r.tip_load) - r.measured).squaredNorm();
    return sum;
  });
  BeamFit fit;
  fit.young_modulus = std::exp(log_modulus);
  const auto predicted = predictions(model, fit.young_modulus, recordings);
  for (const BeamRecording& r : recordings)
    fit.errors.push_back(predicted.at(r.tip_load) - r.measured);
  return fit;
}

double tip_error(const MarkerMotion& errors) { return errors.rowwise().mean().norm(); }

double marker_error(const MarkerMotion& errors) { return errors.colwise().norm().maxCoeff(); }

int run_beam(const BeamOptions& options, std::ostream& out) {
  const std::vector<BeamRecording> recordings =
      read_beam(options.data / "beam_dragonskin/static_deflection.csv");
  const BeamModel model(options.grid);
  const BeamFit fit = fit_beam(model, recordings);
  double heaviest = 0, squares = 0, worst = 0;
  common::Table table({"beam_dragonskin, error mm", "load N", "tip", "tip_top", "tip_left",
                       "tip_right", "left out: E kPa", "tip", "worst marker"});
  json results;
  for (std::size_t i = 0; i < recordings.size(); ++i) {
    const BeamRecording& r = recordings[i];
    const MarkerMotion& errors = fit.errors[i];
    const BeamFit without = fit_beam(model, recordings, static_cast<int>(i));
    heaviest = std::max(heaviest, r.tip_load);
    squares += errors.squaredNorm();
    worst = std::max(worst, tip_error(errors));
    table.add({r.name, common::number(r.tip_load, 3), common::number(tip_error(errors) / kMm, 2),
               common::number(errors.col(0).norm() / kMm, 2),
               common::number(errors.col(1).norm() / kMm, 2),
               common::number(errors.col(2).norm() / kMm, 2),
               common::number(1e-3 * without.young_modulus, 1),
               common::number(tip_error(without.errors[i]) / kMm, 2),
               common::number(marker_error(without.errors[i]) / kMm, 2)});
    json j = to_json(r, errors);
    j["left_out"] = to_json(r, without.errors[i]);
    j["left_out"]["young_modulus"] = without.young_modulus;
    results.push_back(j);
  }
  const double rms = std::sqrt(squares / static_cast<double>(kBeamMarkers * recordings.size()));

  const CaseProblem loaded = model.problem(fit.young_modulus, heaviest);
  const IncrementalRun run = run_incremental(loaded, solve(loaded).positions, 500);
  const bool met = worst <= kGoal && run.times.p99 <= kBudget && run.converged;
  table.print(out);
  out << "One E for all: " << common::number(1e-3 * fit.young_modulus, 1)
      << " kPa; RMS of all markers " << common::number(rms / kMm, 2) << " mm. Mesh "
      << options.grid.text() << ", quadratic, " << loaded.body.mesh.node_count()
      << " nodes: " << common::number(run.times.p50, 0) << " us p50, "
      << common::number(run.times.p99, 0)
      << " us p99 per tick.\nTip within 1 mm at 1 kHz: " << (met ? "met" : "MISSED") << "\n";
  if (!options.json.empty()) {
    common::write_json({{"young_modulus", fit.young_modulus},
                        {"rms_error_m", rms},
                        {"tip_error_max_m", worst},
                        {"mesh", options.grid.text()},
                        {"nodes", loaded.body.mesh.node_count()},
                        {"step_p50_us", run.times.p50},
                        {"step_p99_us", run.times.p99},
                        {"iterations", run.times.iterations},
                        {"recordings", results}},
                       options.json);
  }
  return met ? 0 : 1;
}

}  // namespace palpate::cases
