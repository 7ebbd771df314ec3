#include <algorithm>
#include <limits>
#include <stdexcept>

#include "rt/plugin/fence.hpp"
#include "rt/plugin/plugged.hpp"
#include "rt/plugin/plugin_guards.hpp"

namespace palpate::plugin {
namespace {

class GuardedSensorModel final : public sensing::SensorModel {
 public:
  GuardedSensorModel(std::unique_ptr<PluginSensorModel> model, const std::string& name)
      : model_(std::move(model), name) {
    model_.set_up([](PluginSensorModel& made) { made.reset(); });
  }

  UpdateResult update(const sensing::Signals& signals,
                      sensing::ContactSet& contacts) noexcept override {
    sensing::ContactSet& out = contacts_.value;
    const int others = contacts.count;
    out = contacts;
    UpdateResult result;
    const bool ended =
        model_.call([&](PluginSensorModel& model) { result = model.update(signals, out); });
    model_.check(contacts_);
    if (!ended || model_.why() != nullptr) return {Status::kFault, model_.why()};
    const bool sound = out.count >= others && out.count <= static_cast<int>(out.contacts.size()) &&
                       std::all_of(out.contacts.begin() + others, out.contacts.begin() + out.count,
                                   is_known_source);
    if (!sound || result.reason == nullptr)
      return {Status::kFault, "the plug-in gives contacts that cannot be"};
    for (int i = others; i < out.count; ++i) contacts.contacts[i] = out.contacts[i];
    contacts.count = out.count;
    return result;
  }

  void zero() noexcept override {
    model_.call([](PluginSensorModel& model) { model.zero(); });
  }
  void reset() noexcept override { model_.reset(); }
  sensing::SensorState save() const noexcept override {
    Fenced<sensing::SensorState> state;
    const bool ended = model_.call([&](PluginSensorModel& model) { state.value = model.save(); });
    return ended ? state.value : sensing::SensorState();
  }
  bool restore(const sensing::SensorState& state) noexcept override {
    bool taken = false;
    return model_.call([&](PluginSensorModel& model) { taken = model.restore(state); }) && taken;
  }

 private:
  static bool is_known_source(const sensing::Contact& contact) {
    return contact.source >= sensing::Source::kWrist0 && contact.source <= sensing::Source::kManual;
  }

  Plugged<PluginSensorModel> model_;
  Fenced<sensing::ContactSet> contacts_;
};

/// Loads with guard words in the spare capacity behind the last one that is allowed.
class FencedLoads {
 public:
  explicit FencedLoads(int most) : most_(static_cast<std::size_t>(most)) {
    value.loads.resize(most_ + kSpare);
    begin_ = value.loads.data();
    put_guard_words(begin_ + most_);
    value.loads.clear();
  }
  /// Nothing was written behind, and the list was not replaced by another.
  bool is_intact() const noexcept {
    return value.loads.data() == begin_ && value.loads.size() <= most_ &&
           plugin::is_intact(begin_ + most_);
  }
  void repair() noexcept {
    if (value.loads.data() == begin_) put_guard_words(begin_ + most_);
  }

  contact::ContactLoads value;

 private:
  static constexpr std::size_t kSpare =
      (8 * kGuardWords + sizeof(contact::NodalLoad) - 1) / sizeof(contact::NodalLoad);
  std::size_t most_;
  contact::NodalLoad* begin_ = nullptr;
};

class GuardedForceTransformer final : public contact::ForceTransformer {
 public:
  GuardedForceTransformer(std::unique_ptr<PluginForceTransformer> transformer,
                          const std::string& name, int node_count)
      : transformer_(std::move(transformer), name), node_count_(node_count) {
    const auto most = std::make_shared<int>(0);
    transformer_.set_up([most](PluginForceTransformer& made) { *most = made.max_nodes(); });
    max_nodes_ = *most;
    if (max_nodes_ < 1 || max_nodes_ > node_count)
      throw std::invalid_argument("max_nodes() is " + std::to_string(max_nodes_) +
                                  "; allowed: 1 to the " + std::to_string(node_count) +
                                  " nodes of the mesh");
    out_ = std::make_unique<FencedLoads>(max_nodes_);
  }

  int max_nodes() const noexcept override { return max_nodes_; }

  void distribute(const sensing::Contact& contact, const Eigen::Matrix3Xd& positions,
                  contact::ContactLoads& out) noexcept override {
    transformer_.recover();  // it has no state that would be undefined
    contact::ContactLoads& own = out_->value;
    own.source = out.source;
    own.accepted = out.accepted;
    own.location = out.location;
    own.loads.clear();
    const bool ended = transformer_.call(
        [&](PluginForceTransformer& made) { made.distribute(contact, positions, own); });
    transformer_.check(*out_);
    out.loads.clear();
    const bool sound =
        ended && transformer_.why() == nullptr &&
        std::all_of(own.loads.begin(), own.loads.end(), [this](const contact::NodalLoad& load) {
          return load.node >= 0 && load.node < node_count_;
        });
    if (!sound) {
      // The pipeline treats a load that is not finite as a fault.
      out.push(0, Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN()));
      return;
    }
    out.source = own.source;
    out.accepted = own.accepted;
    out.location = own.location;
    for (const contact::NodalLoad& load : own.loads)
      if (!out.push(load.node, load.force)) out.accepted = false;
  }

 private:
  Plugged<PluginForceTransformer> transformer_;
  int node_count_;
  int max_nodes_ = 0;
  std::unique_ptr<FencedLoads> out_;
};

}  // namespace

std::unique_ptr<sensing::SensorModel> guard(std::unique_ptr<PluginSensorModel> model,
                                            const std::string& name) {
  return std::make_unique<GuardedSensorModel>(std::move(model), name);
}

std::unique_ptr<contact::ForceTransformer> guard(
    std::unique_ptr<PluginForceTransformer> transformer, const std::string& name, int node_count) {
  return std::make_unique<GuardedForceTransformer>(std::move(transformer), name, node_count);
}

}  // namespace palpate::plugin
