#include "core/estimation/force_driven.hpp"

#include "core/elasticity/body.hpp"
#include "core/estimation/nodal_loads.hpp"
#include "core/math/option_check.hpp"

namespace palpate::estimation {

ForceDriven::Options ForceDriven::Options::sensing_launch() noexcept {
  Options options;
  options.variant = Variant::kAsReleased;
  options.average = 0.6;
  options.delay = 0.16;
  return options;
}

ForceDriven::ForceDriven(const elasticity::Body& body, const Options& options)
    : options_(options), step_watch_(options.step) {
  math::check_positive(options.fade, "fade");
  math::check_positive(options.period, "period");
  math::check_not_negative(options.average, "average");
  math::check_not_negative(options.delay, "delay");
  math::check_option(options.average + options.delay < 1e5 * options.period, "average and delay",
                     options.average + options.delay, "below 100,000 periods together");
  const int window = std::max(1, static_cast<int>(std::lround(options.average / options.period)));
  const int delay = static_cast<int>(std::lround(options.delay / options.period));
  sources_.reserve(kSources);
  for (int i = 0; i < kSources; ++i) {
    sources_.push_back(
        {{}, 0, false, false, math::DelayLine<3>(delay), math::MovingAverage<3>(window)});
    // several contacts of one source may load the same node
    sources_.back().loads.reserve(2 * body.mesh.node_count());
  }
}

void ForceDriven::reset() noexcept {
  for (SourceLoads& source : sources_) {
    source.loads.clear();
    source.factor = 0;
    source.seen = source.present = false;
    source.delay.reset();
    source.average.reset();
  }
  step_watch_.reset();
}

void ForceDriven::activate(elasticity::DeformationModel& model) noexcept {
  reset();
  for (int i = 0; i < static_cast<int>(model.body().grasps.size()); ++i) model.release(i);
  const bool repaired = options_.variant == Variant::kRepaired;
  model.set_gravity(repaired ? model.body().gravity_O : Eigen::Vector3d(Eigen::Vector3d::Zero()));
}

UpdateResult ForceDriven::update(const EstimationInputs& inputs,
                                 elasticity::DeformationModel& model, Estimate& estimate) noexcept {
  const bool repaired = options_.variant == Variant::kRepaired;
  UpdateResult result = gather(inputs, model.body().mesh.node_count());
  if (!step_guard_.accepts(inputs.dt))
    result = {Status::kDegraded, "time step is not positive and finite"};
  const double dt = step_guard_.step();

  model.loads().setZero();
  for (int s = 0; s < kSources; ++s) {
    SourceLoads& source = sources_[s];
    if (repaired) {
      fade(source, dt);
      if (is_wrist(static_cast<sensing::Source>(s)) && source.seen && !source.present) {
        result = {Status::kDegraded, "no fresh wrench at the wrist"};
      }
    } else if (source.present) {
      refilter(source);
    }
    for (const contact::NodalLoad& load : source.loads) {
      model.loads().col(load.node) += source.factor * load.force;
    }
  }

  estimate.step = model.step(dt);
  const int grasps = std::min(inputs.grasp_count, static_cast<int>(model.body().grasps.size()));
  for (int i = 0; i < grasps; ++i) {
    estimate.X_OG[i] = elasticity::grasp_pose(model.body(), i, model.positions());
    estimate.reaction[i] = wrist_wrench(i, model.positions(), estimate.X_OG[i].translation());
  }
  estimate.log_young_modulus = std::log(model.body().material.young_modulus);
  estimate.poisson_ratio = model.body().material.poisson_ratio;

  const UpdateResult step = step_watch_.judge(estimate.step, dt);
  return step.is_ok() ? result : step;
}

/// Collects the loads of the contacts received in this tick. Returns an error message, or "".
UpdateResult ForceDriven::gather(const EstimationInputs& inputs, int node_count) noexcept {
  UpdateResult result;
  for (SourceLoads& source : sources_) source.present = false;
  for (int i = 0; i < inputs.contact_count; ++i) {
    const contact::ContactLoads& contact = inputs.contacts[i];
    if (!contact.accepted) continue;
    SourceLoads& source = sources_[static_cast<int>(contact.source)];
    for (const contact::NodalLoad& load : contact.loads) {
      if (!is_valid(load, node_count)) {
        result = {Status::kDegraded, "a contact load is not valid"};
        continue;
      }
      if (!source.present) source.loads.clear();
      source.present = source.seen = true;
      if (source.loads.size() < source.loads.capacity()) {
        source.loads.push_back(load);
      } else {
        result = {Status::kDegraded, "a contact has too many loads"};
      }
    }
  }
  return result;
}

void ForceDriven::fade(SourceLoads& source, double dt) const noexcept {
  source.factor = source.present ? 1.0 : std::max(0.0, source.factor - dt / options_.fade);
}

/// Replaces the received loads by the averaged and delayed total force, distributed as they were.
void ForceDriven::refilter(SourceLoads& source) noexcept {
  Eigen::Vector3d total = Eigen::Vector3d::Zero();
  double magnitude = 0;
  for (const contact::NodalLoad& load : source.loads) {
    total += load.force;
    magnitude += load.force.norm();
  }
  const Eigen::Vector3d force = source.average.update(source.delay.update(total));
  const double count = static_cast<double>(source.loads.size());
  for (contact::NodalLoad& load : source.loads) {
    const double share = magnitude > 0 ? load.force.norm() / magnitude : 1 / count;
    load.force = share * force;
  }
  source.factor = 1;
}

/// Wrench of the loads applied for the wrist that holds `grasp`, about p_OG.
math::Wrench ForceDriven::wrist_wrench(int grasp, const Eigen::Matrix3Xd& positions,
                                       const Eigen::Vector3d& p_OG) const noexcept {
  const SourceLoads& source = sources_[static_cast<int>(sensing::Source::kWrist0) + grasp];
  math::Wrench wrench;
  for (const contact::NodalLoad& load : source.loads) {
    const Eigen::Vector3d force = source.factor * load.force;
    wrench.force += force;
    wrench.torque += (positions.col(load.node) - p_OG).cross(force);
  }
  return wrench;
}

}  // namespace palpate::estimation
