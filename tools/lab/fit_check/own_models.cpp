#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "rt/config/installation.hpp"
#include "tools/fit/held/held_decay.hpp"
#include "tools/fit/held/held_object.hpp"
#include "tools/fit/experiments/uniaxial.hpp"
#include "tools/lab/fit_check/coverage.hpp"

namespace palpate::fit_check {
namespace {

using Eigen::VectorXd;

VectorXd starts(const fit::Experiment& experiment) {
  VectorXd p(experiment.parameters().size());
  for (Eigen::Index k = 0; k < p.size(); ++k) p[k] = experiment.parameters()[k].start;
  return p;
}

/// The long soft bar of the examples on a mesh that a fit takes a tenth of a second on.
fit::HeldCell small_bar() {
  return fit::read_held_cell(
      (config::data_folder() / "rt/config/examples/bar_long_soft.yaml").string(),
      {"object.mesh.box.cells=[10, 1, 1]", "object.order=linear",
       "object.damping={mass_factor: 1, stiffness_factor: 1e-4}"});
}

math::Pose flange_at(const fit::HeldCell& cell, const math::Vector6d& motion) {
  const math::Pose& rest = cell.object.body.grasps[0].X_OG_rest;
  const math::Pose X_OG = math::make_pose(math::exp_rotation(motion.tail<3>()) * rest.linear(),
                                          rest.translation() + motion.head<3>());
  return cell.frames.X_WO * X_OG * cell.frames.X_EG.inverse();
}

OwnModel held_bar() {
  const fit::HeldCell cell = small_bar();
  fit::HeldRecording recording;
  recording.deviation << 0.02, 0.02, 0.02, 2e-3, 2e-3, 2e-3;
  const double motions[][6] = {{0, 0, 0, 0, 0, 0},          {0.02, 0, 0, 0, 0, 0},
                               {-0.01, 0.03, 0, 0, 0, 0},   {0, 0, 0.06, 0, -0.3, 0},
                               {0, 0, 0, 0.7, 0, 0},        {0.01, 0, 0, -0.7, 0, 0},
                               {0.01, -0.05, 0, 0, 0, 0.3}, {0.02, 0, -0.05, 0, 0.2, 0}};
  for (const auto& motion : motions) {
    fit::HeldSample sample;
    sample.time = static_cast<double>(recording.samples.size());
    sample.X_WE = flange_at(cell, Eigen::Map<const math::Vector6d>(motion));
    recording.samples.push_back(sample);
  }
  const auto held = std::make_shared<fit::HeldObject>("held_object", cell, recording);
  VectorXd truth = starts(*held);
  truth[0] = 26e3;
  truth[1] = 0.25;
  return {held, truth};
}

OwnModel ringing_bar() {
  const fit::HeldCell cell = small_bar();
  fit::HeldRinging ringing;
  ringing.X_WE = flange_at(cell, math::Vector6d::Zero());
  ringing.times.setLinSpaced(200, 0, 1);
  ringing.readings.setZero(6, 200);
  ringing.deviation << 4e-3, 4e-3, 4e-3, 4e-4, 4e-4, 4e-4;
  const auto decay =
      std::make_shared<fit::HeldDecay>("held_decay", cell, std::vector<fit::HeldRinging>{ringing},
                                       fit::HeldDecayOptions{2, false, true, false});
  math::Vector6d twist = math::Vector6d::Zero();
  twist[1] = twist[2] = 0.2;
  VectorXd truth = decay->after_stop(starts(*decay), 0, twist);
  truth[0] *= 0.97;
  truth[2] = 2.2;
  return {decay, truth};
}

/// A bar of 20 x 10 x 10 mm pulled to 40 %; its own recording is the model's, so that the file only
/// says how far it is pulled.
OwnModel pulled_bar(const std::string& folder) {
  const auto file = std::filesystem::path(folder) / "pulled_bar.csv";
  std::ofstream out(file);
  out << "u_mm,F_N,w_mm\n";
  for (int i = 0; i <= 40; ++i) out << 0.2 * i << ',' << 0.8 * i << ',' << 10 - 0.03 * i << '\n';
  if (!out.flush()) throw std::runtime_error("cannot write " + file.string());
  const config::Node node = config::Node::from_text(
      "kind: uniaxial\nname: uniaxial\nfile: pulled_bar.csv\nmodel: neo_hookean\n"
      "direction: tension\npoisson_ratio: free\nload_bias: free\ndeviation: 0.3\n"
      "width_deviation: 2e-5\n"
      "columns: {displacement: {name: u_mm, unit: mm}, force: {name: F_N, unit: N},"
      " width: {name: w_mm, unit: mm}}\n"
      "geometry: {length: 20 mm, width: 10 mm, thickness: 10 mm}\n");
  const std::shared_ptr<fit::Experiment> bar = fit::make_uniaxial(node, folder);
  VectorXd truth = starts(*bar);
  truth[0] = 8e5;
  truth[1] = 0.4;
  return {bar, truth};
}

}  // namespace

std::vector<OwnModel> own_models(const std::string& folder) {
  return {pulled_bar(folder), ringing_bar(), held_bar()};
}

}  // namespace palpate::fit_check
