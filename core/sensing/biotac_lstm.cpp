#include "core/sensing/biotac_lstm.hpp"

#include <algorithm>
#include <cmath>

#include "core/math/option_check.hpp"

namespace palpate::sensing {
namespace {

constexpr std::uint64_t kSeed = 1;       // seed of the scattered electrode positions
constexpr double kIntervalShare = 0.02;  // weight of a new interval in the smoothed one
constexpr double kRateTolerance = 0.2;   // relative deviation of the sample interval

void check_inputs(const std::vector<int>& inputs) {
  for (const int input : inputs)
    math::check_option(input < kTactileInputCount, "inputs", input,
                       "below " + std::to_string(kTactileInputCount));
}

}  // namespace

Eigen::Vector3d place_of_normal(const Eigen::Vector3d& direction,
                                const Eigen::Vector3d& near) noexcept {
  Eigen::Vector3d p = kSkinRadius * direction.normalized();
  p.x() = near.x() < 0 ? near.x() : std::max(p.x(), 0.0);
  return project_on_skin(p);
}

BiotacLstm::BiotacLstm(const Options& options, std::unique_ptr<Executor> force,
                       std::optional<Direction> direction)
    : FingertipModel(options.tare_samples),
      options_(options),
      force_(std::move(force), options.inputs, options.outputs),
      random_(kSeed) {
  options.check();
  check_inputs(options.inputs);
  math::check_option(options.outputs.size() == 3, "outputs", options.outputs.size(), "3 indices");
  math::check_positive(options.rate, "rate");
  math::check_option(options.largest_force > options.contact_force, "largest_force",
                     options.largest_force,
                     "above contact_force, " + std::to_string(options.contact_force));
  if (direction) {
    check_inputs(direction->inputs);
    math::check_option(direction->outputs.size() == 3, "direction.outputs",
                       direction->outputs.size(), "3 indices");
    direction_.emplace(std::move(direction->executor), direction->inputs, direction->outputs);
    R_TN_ = direction->R_TN;
  }
  reset();
}

void BiotacLstm::reset() noexcept {
  force_.reset();
  if (direction_) direction_->reset();
  reset_contact();
  random_ = math::Random(kSeed);
  has_time_ = limited_ = false;
  interval_ = 1 / options_.rate;
}

const Executor* BiotacLstm::executor(int index) const noexcept {
  if (index == 0) return &force_.executor();
  return index == 1 && direction_ ? &direction_->executor() : nullptr;
}

void BiotacLstm::take(const BioTac& sample) noexcept {
  const TactileInputs raw = tactile_inputs(sample);
  if (!raw.allFinite()) {
    ++skipped_;
    return;
  }
  const double interval = sample.time - time_;
  if (has_time_ && interval >= 0 && interval <= options_.max_age)
    interval_ += kIntervalShare * (interval - interval_);
  time_ = sample.time;
  has_time_ = true;

  tare_.update(raw);
  if (!tare_.is_known()) return;
  inputs_ = raw - tare_.offset();
  force_.step(inputs_);
  if (direction_) direction_->step(inputs_);
}

/// False without sufficient information.
bool BiotacLstm::locate() noexcept {
  const ElectrodeVector counts = inputs_.head<kElectrodeCount>();
  const Localization found =
      locate_contact(counts, options_.localization,
                     scatter_electrodes(counts, options_.localization, options_.scatter, random_));
  const bool has_normal =
      direction_ && direction_->has_answer() && direction_->answer().squaredNorm() > 1e-6;
  if (has_normal) {
    const Eigen::Vector3d normal = R_TN_ * Eigen::Vector3d(direction_->answer());
    location_ = place_of_normal(normal, found.active > 0 ? found.location : location_);
  } else if (found.active > 0) {
    location_ = found.location;
  } else {
    return false;
  }
  return true;
}

/// Status of a reported contact, or of its absence.
UpdateResult BiotacLstm::verdict() const noexcept {
  if (limited_) return {Status::kDegraded, "force beyond what can be: shortened to largest_force"};
  if (direction_ && direction_->has_failed())
    return {Status::kDegraded, "the network of the contact's direction fails or hangs"};
  if (std::abs(interval_ * options_.rate - 1) > kRateTolerance)
    return {Status::kDegraded, "samples do not come at the rate of the network's training"};
  return {};
}

UpdateResult BiotacLstm::update(const Signals& signals, ContactSet& contacts) noexcept {
  const auto& stream = signals.biotac[options_.finger];
  for (int i = 0; i < stream.fresh_count; ++i) take(stream.fresh[i]);

  if (force_.has_failed()) return {Status::kFault, "the network of the force fails or hangs"};
  if (stream.freshness == Freshness::kNoData || !has_time_)
    return {Status::kDegraded, "no tactile sample yet"};
  if (stream.age > options_.max_age) {
    // the network's state belongs to the time before the gap
    force_.restart();
    if (direction_) direction_->restart();
    has_time_ = in_contact_ = has_location_ = false;
    return {Status::kDegraded, "tactile sample is too old"};
  }
  if (!tare_.is_known()) return {Status::kDegraded, "taring"};
  if (!force_.has_answer()) return {Status::kDegraded, "no answer of the network yet"};

  Eigen::Vector3d force = force_.answer();
  const double size = force.norm();
  detect_contact(options_, size);
  limited_ = size > options_.largest_force;
  if (limited_) force *= options_.largest_force / size;
  if (!in_contact_) return verdict();
  // nothing changes between samples
  if (stream.fresh_count > 0 || !has_location_) has_location_ = locate() || has_location_;
  if (!has_location_) {
    const UpdateResult placeless = placeless_.judge(stream.fresh_count);
    return placeless.status == Status::kOk ? verdict() : placeless;
  }

  const UpdateResult reported = report(options_, force, contacts);
  return reported.status == Status::kOk ? verdict() : reported;
}

}  // namespace palpate::sensing
