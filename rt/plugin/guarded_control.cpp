#include <algorithm>
#include <limits>
#include <new>
#include <stdexcept>

#include "rt/plugin/fence.hpp"
#include "rt/plugin/plugged.hpp"
#include "rt/plugin/plugin_guards.hpp"

namespace palpate::plugin {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Length of value and error in the messages, and of the kind.
constexpr int kMostRows = 32, kLongestKind = 31;

class GuardedFeature final : public shape::Feature {
 public:
  GuardedFeature(std::unique_ptr<PluginFeature> feature, const std::string& name,
                 const Eigen::Matrix3Xd& rest)
      : feature_(std::move(feature), name) {
    const auto constants = std::make_shared<Constants>();
    feature_.set_up([constants](const PluginFeature& made) {
      constants->kind = made.kind() == nullptr ? "" : made.kind();
      constants->dimension = made.dimension();
      constants->value_count = made.value_count();
      constants->rest_points = made.rest_points();
      constants->support = made.support();
      for (int i = 0; i < std::min(constants->dimension, kMostRows); ++i)
        constants->units.push_back(made.unit(i));
    });
    is_ = *constants;
    check(static_cast<int>(rest.cols()));
    value_ = FencedNumbers(is_.value_count);
    error_ = FencedNumbers(is_.dimension);
    none_.resize(is_.dimension, 3 * static_cast<Eigen::Index>(is_.support.size()));
    evaluate_first(rest);
  }

  const char* kind() const noexcept override { return is_.kind.c_str(); }
  int dimension() const noexcept override { return is_.dimension; }
  int value_count() const noexcept override { return is_.value_count; }
  shape::Unit unit(int row) const noexcept override { return is_.units[row]; }
  const std::vector<Eigen::Vector3d>& rest_points() const noexcept override {
    return is_.rest_points;
  }
  const std::vector<int>& support() const noexcept override { return is_.support; }

  void evaluate(const Eigen::Matrix3Xd& positions,
                Eigen::Ref<Eigen::VectorXd> value) noexcept override {
    feature_.recover();  // the pipeline calls a feature that has faulted after reset() only
    feature_.call([this, from = &positions](PluginFeature& made) {
      made.evaluate(*from, value_.vector());
      defined_ = made.is_defined();
      jacobian_ = &made.jacobian();
    });
    feature_.check(value_);
    if (feature_.why() == nullptr) check_jacobian();
    if (feature_.why() != nullptr) {
      jacobian_ = &none_;
      defined_ = false;
      value.setConstant(kNan);  // which the pipeline treats as a fault
      return;
    }
    value = value_.vector();
  }

  bool is_defined() const noexcept override { return defined_; }

  void error(const Eigen::Ref<const Eigen::VectorXd>& value,
             const Eigen::Ref<const Eigen::VectorXd>& target,
             Eigen::Ref<Eigen::VectorXd> error) const noexcept override {
    const bool ended = feature_.call(
        [&](const PluginFeature& made) { made.error(value, target, error_.vector()); });
    feature_.check(error_);
    if (ended && feature_.why() == nullptr && error_.vector().allFinite()) {
      error = error_.vector();
      return;
    }
    if (feature_.why() == nullptr) feature_.fail("the plug-in gives an error that is not finite");
    defined_ = false;
    error.setZero();
  }

  const Eigen::SparseMatrix<double>& jacobian() const noexcept override { return *jacobian_; }

  bool is_valid_target(const double* target, int count) const noexcept override {
    bool valid = false;
    return count == is_.value_count && feature_.call([&](const PluginFeature& made) {
      valid = made.is_valid_target(target, count);
    }) && valid;
  }

 private:
  /// With the deadline of set-up, which the loop has not.
  void evaluate_first(const Eigen::Matrix3Xd& rest) {
    struct First {
      Eigen::Matrix3Xd positions;
      FencedNumbers value;
      bool defined = false;
      const Eigen::SparseMatrix<double>* jacobian = nullptr;
    };
    const auto first = std::make_shared<First>();  // outlives a call that does not return
    first->positions = rest;
    first->value = FencedNumbers(is_.value_count);
    feature_.set_up([first](PluginFeature& made) {
      made.evaluate(first->positions, first->value.vector());
      first->defined = made.is_defined();
      first->jacobian = &made.jacobian();
    });
    defined_ = first->defined;
    jacobian_ = first->jacobian;
    if (!first->value.is_intact()) throw std::invalid_argument(kOutOfBounds);
    check_jacobian();
    if (feature_.why() != nullptr) throw std::invalid_argument(feature_.why());
  }

  struct Constants {
    std::string kind;
    int dimension = 0, value_count = 0;
    std::vector<shape::Unit> units;
    std::vector<Eigen::Vector3d> rest_points;
    std::vector<int> support;
  };

  void check(int node_count) const {
    if (is_.kind.empty() || is_.kind.size() > kLongestKind)
      throw std::invalid_argument("kind() must have 1 to 31 characters");
    if (is_.dimension < 1 || is_.value_count < is_.dimension || is_.value_count > kMostRows)
      throw std::invalid_argument("has " + std::to_string(is_.dimension) + " rows and " +
                                  std::to_string(is_.value_count) +
                                  " values; allowed: 1 to 32 rows, and as many values or more");
    for (const int node : is_.support)
      if (node < 0 || node >= node_count)
        throw std::invalid_argument("support() has node " + std::to_string(node) +
                                    ", which the mesh has not");
  }

  void check_jacobian() noexcept {
    const Eigen::SparseMatrix<double>& J = *jacobian_;
    if (J.rows() != none_.rows() || J.cols() != none_.cols() || !J.isCompressed())
      feature_.fail("the plug-in gives a Jacobian of another size");
    else if (!Eigen::Map<const Eigen::VectorXd>(J.valuePtr(), J.nonZeros()).allFinite())
      feature_.fail("the plug-in gives a Jacobian that is not finite");
  }

  Plugged<PluginFeature> feature_;
  Constants is_;
  FencedNumbers value_;
  mutable FencedNumbers error_;
  Eigen::SparseMatrix<double> none_;
  const Eigen::SparseMatrix<double>* jacobian_ = nullptr;
  mutable bool defined_ = false;
};

class GuardedJacobianProvider final : public control::JacobianProvider {
 public:
  GuardedJacobianProvider(std::unique_ptr<PluginJacobianProvider> provider, const std::string& name,
                          int entries)
      : provider_(std::move(provider), name), J_(entries) {
    provider_.set_up([](PluginJacobianProvider& made) { made.reset(); });
  }

  void observe(const control::Experience& now) noexcept override {
    provider_.call([&](PluginJacobianProvider& made) { made.observe(now); });
  }

  bool update(const shape::Feature& feature, const elasticity::DeformationModel& model,
              const math::Pose& X_OG, Eigen::Ref<Eigen::MatrixXd> J) noexcept override {
    if (J_.size() != J.size()) return false;
    bool known = false;
    const auto own = J_.matrix(J.rows());
    provider_.call([&](PluginJacobianProvider& made) {
      known = made.update(feature, model, X_OG, J_.matrix(J.rows()));
    });
    provider_.check(J_);
    if (known && !own.allFinite())
      provider_.fail("the plug-in gives a Jacobian that is not finite");
    if (provider_.why() != nullptr || !known) return false;
    J = own;
    return true;
  }

  bool commands(const control::LawInputs& inputs, math::Twist& V_O_G) noexcept override {
    bool moves = false;
    twist_.value = V_O_G;
    provider_.call(
        [&](PluginJacobianProvider& made) { moves = made.commands(inputs, twist_.value); });
    provider_.check(twist_);
    if (provider_.why() != nullptr) {
      // The pipeline treats a command that is not finite as a fault.
      V_O_G.linear.setConstant(kNan);
      return true;
    }
    if (!moves) return false;
    V_O_G = twist_.value;
    return true;
  }

  void reset() noexcept override { provider_.reset(); }

 private:
  Plugged<PluginJacobianProvider> provider_;
  FencedNumbers J_;
  Fenced<math::Twist> twist_;
};

class GuardedControlLaw final : public control::ControlLaw {
 public:
  GuardedControlLaw(std::unique_ptr<PluginControlLaw> law, const std::string& name)
      : law_(std::move(law), name) {}

  void configure_for(const shape::Feature& feature) override {
    try {
      law_.set_up([to = &feature](PluginControlLaw& made) {
        made.configure_for(*to);
        made.reset();
      });
    } catch (const std::exception& error) {
      throw std::invalid_argument(error.what());
    } catch (...) {
      throw std::invalid_argument("the plug-in threw something that is no std::exception");
    }
    unreachable_ = FencedNumbers(feature.dimension());
  }

  void compute(const control::LawInputs& inputs, control::LawOutput& output) noexcept override {
    PluginLawOutput& own = output_.value;
    unreachable_.vector().setZero();
    own.V_O_G = own.V_O_G_second = math::Twist();
    own.joint_velocity.setZero(output.joint_velocity.size());
    new (&own.unreachable) Eigen::Map<Eigen::VectorXd>(unreachable_.data(), unreachable_.size());
    own.remark = "";
    const bool ended = law_.call([&](PluginControlLaw& made) { made.compute(inputs, own); });
    law_.check(output_, unreachable_);
    output.V_O_G_second = math::Twist();
    output.joint_velocity.setZero();
    output.unreachable = unreachable_.vector();
    const char* wrong = law_.why();
    if (wrong == nullptr &&
        (own.remark == nullptr || own.unreachable.size() != unreachable_.size() ||
         own.joint_velocity.size() != output.joint_velocity.size()))
      wrong = "the plug-in changed the length of an output, or has no remark";
    if (wrong == nullptr && !own.joint_velocity.allFinite()) wrong = "the command is not finite";
    if (!ended || wrong != nullptr) {
      // The pipeline treats a command that is not finite as a fault, of which this is the reason.
      output.V_O_G.linear.setConstant(kNan);
      output.V_O_G.angular.setZero();
      output.unreachable.setZero();
      output.remark = wrong;
      return;
    }
    output.V_O_G = own.V_O_G;
    output.V_O_G_second = own.V_O_G_second;
    output.joint_velocity = own.joint_velocity;
    output.remark = own.remark;
  }

  void reset() noexcept override { law_.reset(); }

 private:
  Plugged<PluginControlLaw> law_;
  FencedNumbers unreachable_;
  Fenced<PluginLawOutput> output_;
};

}  // namespace

std::unique_ptr<shape::Feature> guard(std::unique_ptr<PluginFeature> feature,
                                      const std::string& name, const Eigen::Matrix3Xd& rest) {
  return std::make_unique<GuardedFeature>(std::move(feature), name, rest);
}

std::unique_ptr<control::JacobianProvider> guard(std::unique_ptr<PluginJacobianProvider> provider,
                                                 const std::string& name, int entries) {
  return std::make_unique<GuardedJacobianProvider>(std::move(provider), name, entries);
}

std::unique_ptr<control::ControlLaw> guard(std::unique_ptr<PluginControlLaw> law,
                                           const std::string& name) {
  return std::make_unique<GuardedControlLaw>(std::move(law), name);
}

}  // namespace palpate::plugin
