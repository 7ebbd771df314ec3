// A library of components that violate all rules for plug-ins. The kind of violation is a
// parameter.

#include <chrono>
#include <cstdlib>
#include <limits>
#include <memory>
#include <stdexcept>
#include <thread>

#include "rt/plugin/plugin.hpp"

namespace {

namespace plugin = palpate::plugin;
namespace config = palpate::config;
namespace contact = palpate::contact;
namespace control = palpate::control;
namespace elasticity = palpate::elasticity;
namespace estimation = palpate::estimation;
namespace sensing = palpate::sensing;
namespace shape = palpate::shape;
using plugin::PluginCell;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

struct Options {
  std::string does = "nothing";
  int after = 0;
};

config::OptionTable<Options> table() {
  std::vector<std::pair<std::string, std::string>> kinds;
  for (const char* kind :
       {"nothing", "throw", "throw_number", "allocate", "nan", "many", "bad_node", "bad_source",
        "overrun", "resize", "fail_setup", "hang", "hang_setup", "hang_warm_up", "slow_warm_up",
        "throw_warm_up", "throw_number_warm_up"})
    kinds.emplace_back(kind, kind);
  return config::OptionTable<Options>()
      .choice("does", "kind of violation", kinds, &Options::does)
      .integer("after", "cycles before it", {0, 1000000}, &Options::after);
}

[[noreturn]] void hang() {
  for (;;) std::this_thread::sleep_for(std::chrono::hours(1));
}

/// Behaviour of a component after `after` cycles.
class Mischief {
 public:
  explicit Mischief(const Options& options) : kind_(options.does), left_(options.after) {
    if (kind_ == "hang_setup") hang();
    if (kind_ == "fail_setup") throw std::runtime_error("no such hardware");
  }
  bool is(const char* kind) {
    if (kind_ != kind) return false;
    return left_ == 0 || --left_ == 0;
  }
  void act() {
    if (is("throw")) throw std::runtime_error("on purpose");
    if (is("throw_number")) throw 42;
    if (is("hang")) hang();
    if (is("allocate")) block_ = std::make_unique<char[]>(100);
  }
  /// In a component's first call.
  void warm_up() const {
    if (kind_ == "hang_warm_up") hang();
    if (kind_ == "throw_warm_up") throw std::runtime_error("cannot warm up");
  }

 private:
  std::string kind_;
  int left_;
  std::unique_ptr<char[]> block_;
};

/// Writes the word behind an object.
template <class T>
void overrun(T& object) {
  auto* volatile behind = reinterpret_cast<unsigned char*>(&object + 1);
  for (int i = 0; i < 8; ++i) behind[i] = 0;
}

class Sensor : public plugin::PluginSensorModel {
 public:
  explicit Sensor(const Options& options) : mischief_(options) {}
  palpate::UpdateResult update(const sensing::Signals&, sensing::ContactSet& contacts) override {
    sensing::Contact contact;
    contact.source = sensing::Source::kWrist0;
    contact.wrench.force.setConstant(mischief_.is("nan") ? kNan : 0.125);
    if (mischief_.is("bad_source")) contact.source = static_cast<sensing::Source>(77);
    contacts.push(contact);
    if (mischief_.is("many")) contacts.count = 1000;
    if (mischief_.is("overrun")) overrun(contacts);
    mischief_.act();
    return {};
  }
  void reset() override { mischief_.warm_up(); }

 private:
  Mischief mischief_;
};

class Transformer : public plugin::PluginForceTransformer {
 public:
  explicit Transformer(const Options& options) : mischief_(options) {}
  int max_nodes() const override {
    mischief_.warm_up();
    return 1;
  }
  void distribute(const sensing::Contact& contact, const Eigen::Matrix3Xd&,
                  contact::ContactLoads& out) override {
    mischief_.act();
    if (mischief_.is("overrun")) {
      for (int i = 0; i < 2; ++i) out.push(0, Eigen::Vector3d::Zero());
      return;
    }
    out.location = contact.location;
    out.accepted = true;
    out.push(mischief_.is("bad_node") ? 1 << 30 : 0,
             mischief_.is("nan") ? Eigen::Vector3d::Constant(kNan) : contact.wrench.force);
  }

 private:
  Mischief mischief_;
};

class Provider : public plugin::PluginJacobianProvider {
 public:
  explicit Provider(const Options& options) : mischief_(options) {}
  bool update(const palpate::shape::Feature&, const palpate::elasticity::DeformationModel&,
              const palpate::math::Pose&, Eigen::Ref<Eigen::MatrixXd> J) override {
    mischief_.act();
    J.setIdentity();
    if (mischief_.is("nan")) J.setConstant(kNan);
    if (mischief_.is("overrun")) J.data()[J.size()] = 0;
    return true;
  }
  void reset() override { mischief_.warm_up(); }

 private:
  Mischief mischief_;
};

class Law : public plugin::PluginControlLaw {
 public:
  Law(const Options& options, const PluginCell& cell) : mischief_(options), period_(cell.period) {}
  void configure_for(const palpate::shape::Feature& feature) override {
    mischief_.warm_up();
    if (mischief_.is("slow_warm_up")) {
      std::this_thread::sleep_for(std::chrono::seconds(5));
      rows_ = feature.dimension() + static_cast<int>(feature.rest_points().size());
    }
    if (mischief_.is("throw_number_warm_up")) throw 42;
  }
  void compute(const control::LawInputs& inputs, plugin::PluginLawOutput& output) override {
    mischief_.act();
    output.V_O_G.linear.x() = 0.01 * inputs.dt / period_;
    if (mischief_.is("nan")) output.V_O_G.angular.z() = kNan;
    if (mischief_.is("resize")) new (&output.unreachable) Eigen::Map<Eigen::VectorXd>(nullptr, 0);
    if (mischief_.is("overrun")) output.unreachable.data()[output.unreachable.size()] = 0;
  }

 private:
  Mischief mischief_;
  double period_;
  int rows_ = 0;
};

class Estimator : public plugin::PluginEstimator {
 public:
  explicit Estimator(const Options& options) : mischief_(options) {}
  void activate(elasticity::DeformationModel& model) override {
    mischief_.warm_up();
    model.hold(0, model.body().grasps[0].X_OG_rest);
  }
  palpate::UpdateResult update(const estimation::EstimationInputs& inputs,
                               elasticity::DeformationModel& model,
                               estimation::Estimate& estimate) override {
    mischief_.act();
    estimate.step = model.step(inputs.dt);
    estimate.X_OG[0] = inputs.grasps[0].X_OG;
    if (mischief_.is("nan")) estimate.reaction[0].force.x() = kNan;
    if (mischief_.is("overrun")) overrun(estimate);
    return {};
  }

 private:
  Mischief mischief_;
};

/// Of a rigid object that never moves.
class Model : public plugin::PluginDeformationModel {
 public:
  explicit Model(const Options& options) : mischief_(options) {}
  void prepare() override { mischief_.warm_up(); }
  void hold(int, const palpate::math::Pose&) override {}
  void release(int) override {}
  void set_gravity(const Eigen::Vector3d&) override {}
  elasticity::StepReport step(double, const Eigen::Matrix3Xd&, Nodes positions, Nodes) override {
    mischief_.act();
    if (mischief_.is("nan")) positions(0, 0) = kNan;
    if (mischief_.is("overrun")) positions.data()[positions.size()] = 0;
    elasticity::StepReport report;
    report.status = elasticity::StepStatus::kConverged;
    return report;
  }
  void reset() override { mischief_.act(); }
  palpate::math::Wrench reaction(int) const override { return {}; }

 private:
  Mischief mischief_;
};

/// Position of the node nearest to the point of the example.
class Feature : public plugin::PluginFeature {
 public:
  Feature(const Options& options, const PluginCell& cell) : mischief_(options), jacobian_(3, 3) {
    Eigen::Index nearest = 0;
    (cell.body->mesh.nodes.colwise() - points_[0]).colwise().squaredNorm().minCoeff(&nearest);
    support_[0] = static_cast<int>(nearest);
    for (int i = 0; i < 3; ++i) jacobian_.insert(i, i) = 1;
    jacobian_.makeCompressed();
  }
  const char* kind() const override { return "point"; }
  int dimension() const override { return 3; }
  int value_count() const override { return 3; }
  const std::vector<Eigen::Vector3d>& rest_points() const override { return points_; }
  void evaluate(const Eigen::Matrix3Xd& positions, Eigen::Ref<Eigen::VectorXd> value) override {
    if (first_) mischief_.warm_up();
    first_ = false;
    mischief_.act();
    value = positions.col(support_[0]);
    if (mischief_.is("nan")) value[0] = kNan;
    if (mischief_.is("overrun")) value.data()[value.size()] = 0;
  }
  void error(const Eigen::Ref<const Eigen::VectorXd>& value,
             const Eigen::Ref<const Eigen::VectorXd>& target,
             Eigen::Ref<Eigen::VectorXd> error) const override {
    error = target - value;
  }
  const std::vector<int>& support() const override { return support_; }
  const Eigen::SparseMatrix<double>& jacobian() const override { return jacobian_; }
  bool is_valid_target(const double*, int) const override { return true; }

 private:
  Mischief mischief_;
  bool first_ = true;
  std::vector<Eigen::Vector3d> points_{Eigen::Vector3d(0.25, 0.03, 0.06)};
  std::vector<int> support_{0};
  Eigen::SparseMatrix<double> jacobian_;
};

template <class Component>
std::unique_ptr<Component> make(const Options& options, const PluginCell&) {
  return std::make_unique<Component>(options);
}

std::unique_ptr<Feature> make_feature(const Options& options, const PluginCell& cell) {
  return std::make_unique<Feature>(options, cell);
}

std::unique_ptr<Law> make_law(const Options& options, const PluginCell& cell) {
  return std::make_unique<Law>(options, cell);
}

}  // namespace

PALPATE_PLUGIN(registrar) {
  registrar.sensor_models.add("unruly_sensor", table(), make<Sensor>, plugin::SensorKind::kWrist);
  registrar.force_transformers.add("unruly_transformer", table(), make<Transformer>);
  registrar.estimators.add("unruly_estimator", table(), make<Estimator>);
  registrar.deformation_models.add("unruly_model", table(), make<Model>);
  registrar.features.add("unruly_feature", table(), make_feature);
  registrar.jacobian_providers.add("unruly_provider", table(), make<Provider>);
  registrar.control_laws.add("unruly_law", table(), make_law);
}
