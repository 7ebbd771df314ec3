#pragma once

#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/math/random.hpp"
#include "tools/lab/runs/experiments.hpp"

namespace palpate::studies {

/// A range of uniformly distributed numbers.
struct DrawnRange {
  double least = 0, most = 0;
  double draw(math::Random& random) const { return random.uniform(least, most); }
};

/// An object of discrepancies.yaml, and how large its motions and discrepancies are.
struct DiscrepancyObject {
  std::string name;
  std::filesystem::path scene, configuration;
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();   // m, most along each axis of O
  Eigen::Vector3d rotation_deg = Eigen::Vector3d::Zero();  // most about each axis
  DrawnRange down, side;       // m, of the hand beyond where the obstacle begins
  DrawnRange weight;           // N
  DrawnRange clamp_stiffness;  // N/m, logarithmic
};

/// A kind of discrepancy; ranges that a kind does not have are zero.
struct DiscrepancyKind {
  std::string name;
  int share = 0;         // of the worlds, relative to the other kinds
  DrawnRange clearance;  // m, between object at rest and obstacle
  DrawnRange friction, radius;
  DrawnRange place;     // share of the object's length
  DrawnRange shift;     // m
  DrawnRange duration;  // s
  double factor = 1;    // of the stiffness
  double part = 0;      // of the grasp's length
};

struct DiscrepancyPlan {
  runs::Method method;
  std::string errors;                                    // distribution of model errors, or none
  std::map<std::string, std::vector<std::string>> sets;  // names of objects
  std::vector<DiscrepancyObject> objects;
  std::vector<DiscrepancyKind> kinds;
};

/// Reads discrepancies.yaml. `root`: the source tree. Throws config::Error with file, key, value
/// and allowed range, also where two sets share an object.
DiscrepancyPlan read_discrepancy_plan(const std::filesystem::path& file,
                                      const std::filesystem::path& root);

/// Rigid obstacle in the plant's O: a half-space, or an infinite cylinder.
struct RigidObstacle {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();       // m, on the plane or the cylinder's axis
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  // normal into free space, or axis; unit
  double radius = 0;                                     // m; 0: a half-space

  /// m, from the surface into free space.
  double distance(const Eigen::Vector3d& p) const;
};

/// A world whose truth palpated's model does not describe.
struct DiscrepancyWorld {
  std::string name;  // of its folder
  std::string kind;
  std::string object;
  std::filesystem::path scene, configuration;
  std::vector<std::string> scene_overrides;
  std::vector<std::string> daemon_overrides;  // with those of the method
  double duration = 0;                        // s
  double begin = 0;                           // s since the start, of the hand's motion
  /// s since the start; of an obstacle given by the truth instead: when they touch.
  double onset = 0;
  double end = std::numeric_limits<double>::infinity();  // s; infinite: it stays
  std::optional<RigidObstacle> obstacle;
  std::vector<runs::DrawnValue> drawn;  // of the discrepancy, then of the model error
};

/// Which worlds of a plan.
struct WorldSelection {
  std::string set = "scoring";
  int count = 100;
  int seed = 1;
  std::string errors;  // distribution in place of the plan's, or none; empty: the plan's
  std::string kind;    // of all worlds; empty: each kind has its share
  double minutes = 0;  // least duration of worlds of the kind none, by more poses
};

/// Sets and seeds have independent random numbers; a world depends on the count through its model
/// error alone. Throws std::invalid_argument for an unknown set or kind.
std::vector<DiscrepancyWorld> make_worlds(const DiscrepancyPlan& plan,
                                          const WorldSelection& selection,
                                          const std::filesystem::path& root);

}  // namespace palpate::studies
