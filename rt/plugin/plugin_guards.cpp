#include "rt/plugin/plugin_guards.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

namespace palpate::plugin {
namespace {

constexpr char kThrew[] = "the plug-in threw an exception";
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

class GuardedSensorModel final : public sensing::SensorModel {
 public:
  explicit GuardedSensorModel(std::unique_ptr<PluginSensorModel> model)
      : model_(std::move(model)) {}

  UpdateResult update(const sensing::Signals& signals,
                      sensing::ContactSet& contacts) noexcept override {
    const int others = contacts.count;
    // A component that threw is not called again before reset(), because its state is undefined.
    if (!threw_) {
      try {
        const UpdateResult result = model_->update(signals, contacts);
        const bool sound = contacts.count >= others &&
                           contacts.count <= static_cast<int>(contacts.contacts.size()) &&
                           std::all_of(contacts.contacts.begin() + others,
                                       contacts.contacts.begin() + contacts.count, is_known_source);
        if (sound && result.reason != nullptr) return result;
        contacts.count = others;
        return {Status::kFault, "the plug-in gives contacts that cannot be"};
      } catch (...) {
        threw_ = true;
      }
    }
    contacts.count = others;
    return {Status::kFault, kThrew};
  }

  void zero() noexcept override {
    attempt([this] { model_->zero(); });
  }
  void reset() noexcept override {
    threw_ = false;
    attempt([this] { model_->reset(); });
  }
  sensing::SensorState save() const noexcept override {
    try {
      return model_->save();
    } catch (...) {
      return {};
    }
  }
  bool restore(const sensing::SensorState& state) noexcept override {
    bool taken = false;
    attempt([&] { taken = model_->restore(state); });
    return taken;
  }

 private:
  static bool is_known_source(const sensing::Contact& contact) {
    return contact.source >= sensing::Source::kWrist0 && contact.source <= sensing::Source::kManual;
  }
  template <class Call>
  void attempt(Call call) noexcept {
    try {
      call();
    } catch (...) {
      threw_ = true;
    }
  }

  std::unique_ptr<PluginSensorModel> model_;
  bool threw_ = false;
};

class GuardedForceTransformer final : public contact::ForceTransformer {
 public:
  GuardedForceTransformer(std::unique_ptr<PluginForceTransformer> transformer, int node_count)
      : transformer_(std::move(transformer)), node_count_(node_count) {
    max_nodes_ = transformer_->max_nodes();
    if (max_nodes_ < 1 || max_nodes_ > node_count)
      throw std::invalid_argument("max_nodes() is " + std::to_string(max_nodes_) +
                                  "; allowed: 1 to the " + std::to_string(node_count) +
                                  " nodes of the mesh");
  }

  int max_nodes() const noexcept override { return max_nodes_; }

  void distribute(const sensing::Contact& contact, const Eigen::Matrix3Xd& positions,
                  contact::ContactLoads& out) noexcept override {
    try {
      transformer_->distribute(contact, positions, out);
      const bool sound =
          std::all_of(out.loads.begin(), out.loads.end(), [this](const contact::NodalLoad& load) {
            return load.node >= 0 && load.node < node_count_;
          });
      if (sound) return;
    } catch (...) {
    }
    // the pipeline treats a non-finite load as a fault
    out.loads.clear();
    out.push(0, Eigen::Vector3d::Constant(kNan));
  }

 private:
  std::unique_ptr<PluginForceTransformer> transformer_;
  int node_count_;
  int max_nodes_ = 0;
};

class GuardedJacobianProvider final : public control::JacobianProvider {
 public:
  explicit GuardedJacobianProvider(std::unique_ptr<PluginJacobianProvider> provider)
      : provider_(std::move(provider)) {}

  bool update(const shape::Feature& feature, const elasticity::DeformationModel& model,
              const math::Pose& X_OG, Eigen::Ref<Eigen::MatrixXd> J) noexcept override {
    try {
      return provider_->update(feature, model, X_OG, J) && J.allFinite();
    } catch (...) {
      return false;
    }
  }

 private:
  std::unique_ptr<PluginJacobianProvider> provider_;
};

class GuardedControlLaw final : public control::ControlLaw {
 public:
  explicit GuardedControlLaw(std::unique_ptr<PluginControlLaw> law) : law_(std::move(law)) {}

  void configure_for(const shape::Feature& feature) override {
    try {
      law_->configure_for(feature);
    } catch (const std::exception& error) {
      throw std::invalid_argument(error.what());
    } catch (...) {
      throw std::invalid_argument(kThrew);
    }
    dimension_ = feature.dimension();
  }

  void compute(const control::LawInputs& inputs, control::LawOutput& output) noexcept override {
    output.V_O_G = output.V_O_G_second = math::Twist();
    output.joint_velocity.setZero();
    output.unreachable.setZero();
    output.remark = "";
    const char* wrong = kThrew;
    if (!threw_) {
      try {
        law_->compute(inputs, output);
        if (output.unreachable.size() == dimension_ && output.remark != nullptr) return;
        wrong = "the plug-in changed the length of what is unreachable, or has no remark";
      } catch (...) {
        threw_ = true;
      }
    }
    // The pipeline treats a non-finite command as a fault, of which this is the reason.
    output.V_O_G.linear.setConstant(kNan);
    output.unreachable.setZero(dimension_);
    output.remark = wrong;
  }

  void reset() noexcept override {
    try {
      threw_ = false;
      law_->reset();
    } catch (...) {
      threw_ = true;
    }
  }

 private:
  std::unique_ptr<PluginControlLaw> law_;
  int dimension_ = 0;
  bool threw_ = false;
};

}  // namespace

std::unique_ptr<sensing::SensorModel> guard(std::unique_ptr<PluginSensorModel> model) {
  return std::make_unique<GuardedSensorModel>(std::move(model));
}

std::unique_ptr<contact::ForceTransformer> guard(
    std::unique_ptr<PluginForceTransformer> transformer, int node_count) {
  return std::make_unique<GuardedForceTransformer>(std::move(transformer), node_count);
}

std::unique_ptr<control::JacobianProvider> guard(std::unique_ptr<PluginJacobianProvider> provider) {
  return std::make_unique<GuardedJacobianProvider>(std::move(provider));
}

std::unique_ptr<control::ControlLaw> guard(std::unique_ptr<PluginControlLaw> law) {
  return std::make_unique<GuardedControlLaw>(std::move(law));
}

}  // namespace palpate::plugin
