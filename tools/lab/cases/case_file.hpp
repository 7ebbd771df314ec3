#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/elasticity/body.hpp"

namespace palpate::cases {

/// Part of the surface on which a condition acts: a group of the case's mesh files, and the box of
/// rest positions that holds it (empty if the case gives none).
struct CaseRegion {
  std::string group;
  Eigen::AlignedBox3d box;
};

/// A dead load per rest area: a uniformly distributed force, or a traction (Pa) as a function of
/// rest position.
struct CaseLoad {
  CaseRegion region;
  std::optional<Eigen::Vector3d> total_force;  // N
  std::function<Eigen::Vector3d(const Eigen::Vector3d&)> traction;
};

/// Rigid motion prescribed for a region. G: at its centre, axes of O.
struct CaseGrasp {
  CaseRegion region;
  math::Pose X_OG_rest = math::Pose::Identity();
  math::Pose X_OG = math::Pose::Identity();
};

/// A different material for the elements whose centroid lies in the box.
struct MaterialOverride {
  Eigen::AlignedBox3d box;
  elasticity::Material material;
};

struct CaseProbe {
  Eigen::Vector3d rest;          // m
  Eigen::Vector3d displacement;  // m, of the reference
};

/// A reference case of nonlinear statics, as stored in its folder. SI units, rest frame O.
struct CaseFile {
  std::filesystem::path folder;
  std::string name;
  std::vector<Eigen::AlignedBox3d> boxes;  // whose union is the body; empty for a curved one
  elasticity::Material material;
  std::vector<MaterialOverride> overrides;
  Eigen::Vector3d gravity = Eigen::Vector3d::Zero();  // m/s^2; zero if weight is neglected
  std::optional<CaseRegion> fixed;
  std::vector<CaseLoad> loads;
  std::optional<CaseGrasp> grasp;
  std::map<std::string, std::filesystem::path> meshes;  // by name, without the prefix "mesh_"
  std::vector<CaseProbe> probes;
  nlohmann::json summary =
      nlohmann::json::object();  // notes of the reference's author; may be empty

  double largest_reference() const;  // m, displacement of a probe; 0 rows without probes

  /// config::Error for a key of case.yaml.
  [[noreturn]] void fail(const std::string& key, const std::string& what) const;
};

/// Reads case.yaml, probes.csv and, if present, summary.json. Keys that are not needed here may be
/// absent and unknown keys are ignored; wrong values throw config::Error with file and key. A
/// density of zero is replaced by a positive one: a body always has mass, here without weight.
CaseFile read_case(const std::filesystem::path& folder);

}  // namespace palpate::cases
