#include <cmath>
#include <filesystem>
#include <sstream>
#include <stdexcept>

#include "rt/config/installation.hpp"
#include "sim/scenes/scene.hpp"
#include "tools/fit/runner.hpp"
#include "tools/lab/fit_check/simulated.hpp"

namespace palpate::fit_check {
namespace {

std::string data(const char* path) { return (config::data_folder() / path).string(); }

/// On four sides of the bar's middle part.
std::vector<Eigen::Vector3d> side_markers() {
  std::vector<Eigen::Vector3d> markers;
  for (double x : {0.12, 0.18, 0.24, 0.30, 0.36})
    for (double side : {0.0, 0.06}) {
      markers.emplace_back(x, side, 0.03);
      markers.emplace_back(x, 0.03, side);
    }
  return markers;
}

std::string text_of(const std::vector<Eigen::Vector3d>& points) {
  std::ostringstream text;
  for (const Eigen::Vector3d& p : points)
    text << (text.tellp() > 0 ? ", " : "") << "[" << p.x() << ", " << p.y() << ", " << p.z() << "]";
  return "[" + text.str() + "]";
}

/// The configuration's object on the fitted mesh, with a different assumed material.
std::string believed(const scenes::Scene& scene, const std::string& cells) {
  std::ostringstream text;
  text << "    configuration: " << data("rt/config/examples/bar_long_soft.yaml")
       << "\n    time: sent\n    set:\n"
       << "      - 'object.mesh.box.cells=" << cells << "'\n"
       << "      - object.material.young_modulus=" << 0.7 * scene.plant.young_modulus << "\n"
       << "      - object.material.poisson_ratio=0.4\n"
       << "      - object.material.density=" << scene.plant.density << "\n"
       << "      - 'object.damping={mass_factor: 0.5, stiffness_factor: 0}'\n";
  return text.str();
}

fit::Fit fit_recording(const std::string& recording, const std::string& folder) {
  const fit::Plan plan = fit::read_plan(
      config::Node::from_text(
          "name: simulated\nsolver: {reweigh: false, profile: never}\nrecordings:\n  - " +
              recording,
          "simulated"),
      folder);
  fit::RunOptions options;
  options.data = folder;
  std::vector<fit::JobResult> results = fit::run(plan, options);
  if (!results[0].error.empty()) throw std::runtime_error(results[0].error);
  return std::move(results[0].fit);
}

Statement statement(const fit::Fit& fit, const std::string& parameter, double truth, double bar,
                    bool is_relative) {
  const fit::Estimate* found = fit.find(parameter);
  if (found == nullptr) throw std::runtime_error("the fit has no " + parameter);
  Statement result{parameter, truth, found->value, found->interval[0], found->interval[1]};
  result.error = std::abs(found->value - truth) / (is_relative ? truth : 1);
  result.bar = bar;
  return result;
}

}  // namespace

std::vector<Statement> fit_simulated(const StatementOptions& options) {
  const std::string rests = data("tools/lab/fit_check/bar_rests.yaml"),
                    stops = data("tools/lab/fit_check/bar_stops.yaml");
  const scenes::Scene scene = scenes::read_scene(config::Node::load_file(rests, options.overrides));
  const auto make = [&](const std::string& file, const std::vector<Eigen::Vector3d>& markers,
                        const std::string& name) {
    record({file, options.overrides, markers},
           (std::filesystem::path(options.folder) / (name + ".log")).string(), [&](double share) {
             if (options.progress) options.progress("simulating " + name, share);
           });
  };
  make(rests, side_markers(), "rests");
  make(stops, {}, "stops");

  if (options.progress) options.progress("fitting", 0);
  const fit::Fit at_rest =
      fit_recording("kind: held_object\n    log: rests.log\n" + believed(scene, options.cells) +
                        "    calm: {settle: 1.0, window: 1.0, every: 2.0}\n    markers: " +
                        text_of(side_markers()) + "\n    sought: [poisson_ratio, bias]\n",
                    options.folder);
  if (options.progress) options.progress("fitting", 0.5);
  const fit::Fit ringing = fit_recording(
      "kind: held_decay\n    log: stops.log\n" + believed(scene, options.cells) +
          "    calm: {linear_speed: 5e-3, angular_speed: 2e-2}\n    duration: 2\n    modes: 2\n",
      options.folder);
  return {statement(at_rest, "young_modulus", scene.plant.young_modulus, 0.03, true),
          statement(at_rest, "poisson_ratio", scene.plant.poisson_ratio, 0.03, false),
          statement(ringing, "mass_damping", scene.plant.mass_damping, 0.10, true)};
}

}  // namespace palpate::fit_check
