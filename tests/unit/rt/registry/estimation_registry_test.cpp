#include <gtest/gtest.h>

#include <string>

#include "core/estimation/force_driven.hpp"
#include "core/estimation/wrench_driven.hpp"
#include "rt/registry/registry.hpp"

namespace palpate::registry {
namespace {

/// Builds the estimator configured by `estimation`, on the example's bar.
std::unique_ptr<estimation::Estimator> build_estimator(const std::string& estimation) {
  const config::Node root = config::Node::load_file(
      std::string(PALPATE_SOURCE_DIR) + "/rt/config/examples/bar_long_soft.yaml",
      {"estimation=" + estimation});
  Context context;
  context.frames = read_frames(root);
  const Object object = read_object(root, context.frames);
  context.object = &object;
  const config::Node node = root.child("estimation");
  auto estimator = make_estimator(node, context);
  node.check_all_used();
  return estimator;
}

std::string estimator_error_of(const std::string& estimation) {
  try {
    build_estimator(estimation);
  } catch (const config::Error& error) {
    return error.what();
  }
  return "";
}

TEST(EstimationRegistry, EstimatorsAreMadeByName) {
  EXPECT_NE(
      dynamic_cast<estimation::WrenchDriven*>(build_estimator("{component: wrench_driven}").get()),
      nullptr);
  EXPECT_NE(dynamic_cast<estimation::WrenchDriven*>(
                build_estimator("{component: wrench_driven, time_constant_ms: 50, average_ms: 10, "
                                "least_stiffness: 0.1, wrench_timeout_ms: 20, approach_speed: 0.5}")
                    .get()),
            nullptr);
  EXPECT_NE(
      dynamic_cast<estimation::ForceDriven*>(build_estimator("{component: force_driven}").get()),
      nullptr);
}

TEST(EstimationRegistry, KeysOfOthersAndValuesOutOfRangeAreNamed) {
  for (const auto& [estimation, key] :
       {std::pair("{component: wrench_driven, fade_ms: 10}", "fade_ms"),
        std::pair("{component: wrench_driven, time_constant_ms: 0}", "time_constant_ms"),
        std::pair("{component: wrench_driven, average_ms: -1}", "average_ms"),
        std::pair("{component: wrench_driven, least_stiffness: 0}", "least_stiffness"),
        std::pair("{component: wrench_driven, wrench_timeout_ms: .nan}", "wrench_timeout_ms"),
        std::pair("{component: wrench_driven, approach_speed: 100}", "approach_speed"),
        std::pair("{component: force_driven, least_stiffness: 1}", "least_stiffness"),
        std::pair("{component: wrench}", "wrench_driven")}) {
    const std::string error = estimator_error_of(estimation);
    EXPECT_NE(error.find(key), std::string::npos) << estimation << ": " << error;
  }
}

}  // namespace
}  // namespace palpate::registry
