#include "core/sensing/biotac_linear.hpp"

#include "core/math/option_check.hpp"

namespace palpate::sensing {

BiotacLinear::BiotacLinear(const Options& options)
    : FingertipModel(options.tare_samples), options_(options) {
  options.check();
  const LinearTactileModel& model = options.model;
  math::check_all_finite(model.matrix, "model.matrix");
  math::check_all_finite(model.offset, "model.offset");
  math::check_all_finite(model.place, "model.place");
  const Eigen::Index count = feature_count(model.features);
  const std::string columns = std::to_string(count) + " columns, one for each feature";
  math::check_option(model.matrix.cols() == count, "model.matrix", model.matrix.cols(), columns);
  math::check_option(model.place.size() == 0 || model.place.cols() == count, "model.place",
                     model.place.cols(), columns);
  tare_.start();
}

void BiotacLinear::reset() noexcept {
  reset_contact();
  has_inputs_ = false;
}

UpdateResult BiotacLinear::update(const Signals& signals, ContactSet& contacts) noexcept {
  const auto& stream = signals.biotac[options_.finger];
  for (int i = 0; i < stream.fresh_count; ++i) {
    const TactileInputs raw = tactile_inputs(stream.fresh[i]);
    if (!raw.allFinite()) {
      ++skipped_;
      continue;
    }
    tare_.update(raw);
    inputs_ = raw - tare_.offset();
    has_inputs_ = true;
  }

  if (stream.freshness == Freshness::kNoData || !has_inputs_)
    return {Status::kDegraded, "no tactile sample yet"};
  if (stream.age > options_.max_age) return {Status::kDegraded, "tactile sample is too old"};
  if (!tare_.is_known()) return {Status::kDegraded, "taring"};

  const Eigen::Vector3d force = options_.model.force(inputs_);
  detect_contact(options_, force.norm());
  if (!in_contact_) return {};
  const Localization found = locate_contact(inputs_.head<kElectrodeCount>(), options_.localization);
  if (found.active > 0) {
    location_ = options_.model.place.size() > 0 ? options_.model.location(inputs_) : found.location;
    has_location_ = true;
  }
  if (!has_location_) return placeless_.judge(stream.fresh_count);

  return report(options_, force, contacts);
}

}  // namespace palpate::sensing
