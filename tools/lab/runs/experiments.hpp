#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "tools/lab/runs/feature_on_points.hpp"

namespace palpate::runs {

/// A parameter of a drawn model error.
struct DrawnValue {
  std::string parameter;
  std::string unit;
  double value = 0;
};

/// A level of model error: overrides "path.to.key=value" for --set.
struct Mismatch {
  std::string name;
  std::string about;
  std::vector<std::string> scene;
  std::vector<std::string> daemon;
  std::string family;  // distributions that it was drawn from, such as "calibrated"; empty: none
  std::vector<DrawnValue> drawn;  // its parameters
};

/// Reads a level of mismatch.yaml, with relative changes made absolute for this scene and this
/// configuration of palpated; throws config::Error, also for an unknown level.
Mismatch read_mismatch(const std::filesystem::path& file, const std::string& level,
                       const std::filesystem::path& scene,
                       const std::filesystem::path& configuration);

/// A shape sensing method: overrides for palpated.
struct Method {
  std::string name;
  std::vector<std::string> overrides;
};

/// Reads methods.yaml, in order; throws config::Error.
std::vector<Method> read_methods(const std::filesystem::path& file);

/// Motion of the hand from its first pose in a scene, in O.
struct HandMotion {
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();   // m
  Eigen::Vector3d rotation_deg = Eigen::Vector3d::Zero();  // rotation vector
};

/// Target of a shape feature.
struct ControlTarget : FeatureDefinition {
  std::string name;
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();  // m, in O, from the rest shape
  std::optional<HandMotion>
      hand;                // alternatively: the value of the plant's feature after this motion
  Eigen::VectorXd values;  // as in shape_target_t

  /// Sets `values`: the feature's value of the rest shape, displaced if it is a position; for a
  /// set, every point. Throws std::invalid_argument if there is no such feature of that many
  /// points.
  void displace();

  /// Overrides that configure the feature in palpated.
  std::vector<std::string> daemon_overrides() const;
};

/// Reads targets.yaml; throws config::Error.
std::vector<ControlTarget> read_targets(const std::filesystem::path& file);

}  // namespace palpate::runs
