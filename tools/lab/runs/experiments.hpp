#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "tools/lab/runs/feature_on_points.hpp"

namespace palpate::runs {

/// A level of model error: overrides "path.to.key=value" for --set.
struct Mismatch {
  std::string name;
  std::string about;
  std::vector<std::string> scene;
  std::vector<std::string> daemon;
};

/// Reads a level of mismatch.yaml, its relative changes made absolute for this scene and this
/// configuration of palpated; throws config::Error, also where the level is unknown.
Mismatch read_mismatch(const std::filesystem::path& file, const std::string& level,
                       const std::filesystem::path& scene,
                       const std::filesystem::path& configuration);

/// A way of shape sensing: overrides for palpated.
struct Method {
  std::string name;
  std::vector<std::string> overrides;
};

/// Reads methods.yaml, in its order; throws config::Error.
std::vector<Method> read_methods(const std::filesystem::path& file);

/// How the hand moves from its first pose in a scene, in O.
struct HandMotion {
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();   // m
  Eigen::Vector3d rotation_deg = Eigen::Vector3d::Zero();  // rotation vector
};

/// Where a feature of the shape shall go.
struct ControlTarget : FeatureDefinition {
  std::string name;
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();  // m, in O, from the rest shape
  std::optional<HandMotion> hand;  // instead: what the plant's feature is after this motion
  Eigen::VectorXd values;          // as in shape_target_t

  /// Sets `values`: the feature's of the rest shape, displaced where it is a place; of a set, every
  /// point. Throws std::invalid_argument where there is no such feature of so many points.
  void displace();

  /// What puts the feature into palpated's slot.
  std::vector<std::string> daemon_overrides() const;
};

/// Reads targets.yaml; throws config::Error.
std::vector<ControlTarget> read_targets(const std::filesystem::path& file);

}  // namespace palpate::runs
