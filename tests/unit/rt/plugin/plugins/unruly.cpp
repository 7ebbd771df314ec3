// A library of components that violate all rules for plug-ins. The kind of violation is a
// parameter.

#include <cstdlib>
#include <limits>
#include <memory>
#include <stdexcept>

#include "rt/plugin/plugin.hpp"

namespace {

namespace plugin = palpate::plugin;
namespace contact = palpate::contact;
namespace control = palpate::control;
namespace sensing = palpate::sensing;
using plugin::Parameters;
using plugin::PluginCell;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Behaviour of a component after `after` cycles.
class Mischief {
 public:
  explicit Mischief(const Parameters& parameters)
      : kind_(parameters.choice("does")), left_(parameters.integer("after")) {}
  bool is(const char* kind) {
    if (kind_ != kind) return false;
    return left_ == 0 || --left_ == 0;
  }
  void act() {
    if (is("throw")) throw std::runtime_error("on purpose");
    if (is("throw_number")) throw 42;
    if (is("allocate")) block_ = std::make_unique<char[]>(100);
  }

 private:
  std::string kind_;
  int left_;
  std::unique_ptr<char[]> block_;
};

std::vector<plugin::Parameter> keys() {
  return {plugin::choice("does",
                         {"nothing", "throw", "throw_number", "allocate", "nan", "many", "bad_node",
                          "bad_source", "resize", "fail_setup"},
                         "nothing", "how it errs"),
          plugin::integer("after", 0, 1000000, 0, "cycles that it is good for")};
}

class Sensor : public plugin::PluginSensorModel {
 public:
  explicit Sensor(const Parameters& parameters) : mischief_(parameters) {
    if (mischief_.is("fail_setup")) throw std::runtime_error("no such hardware");
  }
  palpate::UpdateResult update(const sensing::Signals&, sensing::ContactSet& contacts) override {
    sensing::Contact contact;
    contact.source = sensing::Source::kWrist0;
    contact.wrench.force.setConstant(mischief_.is("nan") ? kNan : 0.125);
    if (mischief_.is("bad_source")) contact.source = static_cast<sensing::Source>(77);
    contacts.push(contact);
    if (mischief_.is("many")) contacts.count = 1000;
    mischief_.act();
    return {};
  }
  void reset() override { mischief_.act(); }

 private:
  Mischief mischief_;
};

class Transformer : public plugin::PluginForceTransformer {
 public:
  explicit Transformer(const Parameters& parameters) : mischief_(parameters) {}
  int max_nodes() const override { return 1; }
  void distribute(const sensing::Contact& contact, const Eigen::Matrix3Xd&,
                  contact::ContactLoads& out) override {
    mischief_.act();
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
  explicit Provider(const Parameters& parameters) : mischief_(parameters) {}
  bool update(const palpate::shape::Feature&, const palpate::elasticity::DeformationModel&,
              const palpate::math::Pose&, Eigen::Ref<Eigen::MatrixXd> J) override {
    mischief_.act();
    J.setIdentity();
    if (mischief_.is("nan")) J.setConstant(kNan);
    return true;
  }

 private:
  Mischief mischief_;
};

class Law : public plugin::PluginControlLaw {
 public:
  Law(const Parameters& parameters, const PluginCell& cell)
      : mischief_(parameters), period_(cell.period) {}
  void configure_for(const palpate::shape::Feature&) override {
    if (mischief_.is("fail_setup")) throw 42;
  }
  void compute(const control::LawInputs& inputs, control::LawOutput& output) override {
    mischief_.act();
    output.V_O_G.linear.x() = 0.01 * inputs.dt / period_;
    if (mischief_.is("nan")) output.V_O_G.angular.z() = kNan;
    if (mischief_.is("resize")) output.unreachable.resize(99);
  }

 private:
  Mischief mischief_;
  double period_;
};

}  // namespace

PALPATE_PLUGIN(registrar) {
#if defined(UNRULY_THROWS)
  registrar.control_laws.push_back({"half_done", keys(), nullptr});
  throw std::runtime_error("there is no licence for it");
#elif defined(UNRULY_NAME)
  const auto law = [](const Parameters& p, const PluginCell& c) {
    return std::make_unique<Law>(p, c);
  };
  registrar.control_laws.push_back({UNRULY_NAME, keys(), law});
#else
  registrar.sensor_models.push_back(
      {"unruly_sensor", keys(),
       [](const Parameters& p, const PluginCell&) { return std::make_unique<Sensor>(p); },
       plugin::SensorKind::kWrist});
  registrar.force_transformers.push_back(
      {"unruly_transformer", keys(),
       [](const Parameters& p, const PluginCell&) { return std::make_unique<Transformer>(p); }});
  registrar.jacobian_providers.push_back(
      {"unruly_provider", keys(),
       [](const Parameters& p, const PluginCell&) { return std::make_unique<Provider>(p); }});
  registrar.control_laws.push_back(
      {"unruly_law", keys(),
       [](const Parameters& p, const PluginCell& c) { return std::make_unique<Law>(p, c); }});
#endif
}
