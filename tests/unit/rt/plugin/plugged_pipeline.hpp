#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "rt/pipeline/pipeline.hpp"
#include "tests/support/pipeline_cycles.hpp"
#include "tools/lab/unruly/settings.hpp"

namespace palpate::plugin {

using unruly::estimator, unruly::feature, unruly::kErrors, unruly::kSlots, unruly::law,
    unruly::model, unruly::provider, unruly::sensor, unruly::transformer;
inline const std::string& kUnruly = unruly::kLibrary;

inline config::Node example(std::vector<std::string> overrides) {
  return config::Node::load_file(
      std::string(PALPATE_SOURCE_DIR) + "/rt/config/examples/bar_long_soft.yaml", overrides);
}

inline std::string error_of(const std::vector<std::string>& overrides) {
  try {
    const config::Node root = example(overrides);
    const pipeline::Pipeline pipeline(root, 1e-3);
    root.child("control").check_all_used();
  } catch (const config::Error& error) {
    return error.what();
  }
  return "";
}

inline void expect_complaint(const std::vector<std::string>& overrides,
                             const std::vector<std::string>& words) {
  const std::string error = error_of(overrides);
  for (const std::string& word : words)
    EXPECT_NE(error.find(word), std::string::npos) << word << " is not in: " << error;
}

/// A pipeline that is started with a target, with the signals of a hand that holds the bar.
class Running {
 public:
  explicit Running(const std::vector<std::string>& overrides) : pipeline(example(overrides), 1e-3) {
    signals_ = support::at_rest(pipeline);
    const Eigen::Vector3d target(0.25, 0.03, 0.08);
    const char* reason = "";
    pipeline.start();
    EXPECT_TRUE(pipeline.set_target(1, "point", nullptr, 0, target.data(), 3, reason)) << reason;
  }

  void run(int cycles) {
    for (int i = 0; i < cycles; ++i) {
      support::run(pipeline, signals_, 1);
      const math::Twist twist = pipeline.gate_output(0).V_W_E;
      ASSERT_TRUE(twist.vector().allFinite());
      speed = twist.vector().norm();
    }
  }

  pipeline::Pipeline pipeline;
  double speed = 0;  // of the last command

 private:
  sensing::Signals signals_;
};

}  // namespace palpate::plugin
