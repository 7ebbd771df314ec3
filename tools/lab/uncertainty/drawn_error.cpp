#include "tools/lab/uncertainty/drawn_error.hpp"

#include <algorithm>
#include <cmath>

#include "core/math/constants.hpp"
#include "core/math/random.hpp"
#include "rt/config/node.hpp"
#include "sim/scenes/scene.hpp"
#include "tools/common/table.hpp"

namespace palpate::uncertainty {
namespace {

using Eigen::Vector3d;
using math::kDegree;

constexpr double kOnFace = 1e-9;  // m
constexpr double kLeastPoisson = 0, kMostPoisson = 0.48;
constexpr const char* kAxes[] = {"x", "y", "z"};

/// With fewer digits than machines agree in.
std::string text_of(double value) { return common::formatted("%.9g", value); }

std::string text_of(const Vector3d& v) {
  return "[" + text_of(v.x()) + ", " + text_of(v.y()) + ", " + text_of(v.z()) + "]";
}

std::string text_of(const object::Box& box) {
  return "{lower: " + text_of(box.lower) + ", upper: " + text_of(box.upper) + "}";
}

/// Section `path` ("object.material"); an empty one if it is absent.
config::Node section(config::Node node, const std::string& path) {
  std::size_t begin = 0;
  while (begin <= path.size()) {
    const std::size_t end = std::min(path.find('.', begin), path.size());
    node = node.child_or_empty(path.substr(begin, end - begin));
    begin = end + 1;
  }
  return node;
}

class Draw {
 public:
  Draw(const Distributions& distributions, const LatinHypercube& sample, int index,
       const std::filesystem::path& scene, const std::filesystem::path& configuration)
      : d_(distributions),
        sample_(sample),
        index_(index - 1),
        scene_(scenes::read_scene(config::Node::load_file(scene.string()))),
        configuration_(config::Node::load_file(configuration.string())) {
    level_.name = d_.name + " " + std::to_string(index);
    level_.about = d_.about;
    level_.family = d_.name;
  }

  runs::Mismatch level() {
    sensors();
    camera();
    if (is_held()) {
      dimensions();
      pads();
    }
    clamp_and_grasp();
    material();
    gravity();
    payload();
    mesh();
    return level_;
  }

 private:
  // Only an object on a rig and in a hand can change its size under them.
  bool is_held() const { return !scene_.soft_box && !scene_.plant.grasps.empty(); }

  double share(const std::string& parameter) const { return sample_.at(parameter, index_); }

  double drawn(const std::string& parameter, const char* unit, double value) {
    level_.drawn.push_back({parameter, unit, value});
    return value;
  }

  double normal(const std::string& parameter, const char* unit, double deviation) {
    const double most = d_.truncated_at;
    return drawn(parameter, unit, deviation * truncated_normal(share(parameter), -most, most));
  }

  double half(const std::string& parameter, const char* unit, double deviation) {
    return drawn(parameter, unit, deviation * half_normal(share(parameter), d_.truncated_at));
  }

  double log_uniform(const std::string& parameter, const char* unit, double lower, double upper) {
    return drawn(parameter, unit, lower * std::pow(upper / lower, share(parameter)));
  }

  Vector3d normals(const std::string& parameter, const char* unit, double deviation) {
    Vector3d values;
    for (int axis = 0; axis < 3; ++axis)
      values[axis] = normal(parameter + " " + kAxes[axis], unit, deviation);
    return values;
  }

  void set_scene(const std::string& key, const std::string& value) {
    level_.scene.push_back(key + "=" + value);
  }
  void set_daemon(const std::string& key, const std::string& value) {
    level_.daemon.push_back(key + "=" + value);
  }

  void set_pose(const std::string& key, const std::string& parameter,
                const PoseDeviation& deviation) {
    const Vector3d position = normals(parameter, "m", deviation.position),
                   angles = normals(parameter + " about", "deg", deviation.angle_deg);
    set_scene(key, "{position: " + text_of(position) + ", rpy_deg: " + text_of(angles) + "}");
  }

  void sensors() {
    if (d_.hand.position > 0 || d_.hand.angle_deg > 0)
      set_pose("sensors.kinematics_error", "hand", d_.hand);
    if (d_.force_bias > 0 || d_.torque_bias > 0) {
      math::Vector6d bias = scene_.sensors.force_torque.bias;
      bias.head<3>() += normals("force bias", "N", d_.force_bias);
      bias.tail<3>() += normals("torque bias", "N m", d_.torque_bias);
      std::string text;
      for (const double value : bias) text += (text.empty() ? "" : ", ") + text_of(value);
      set_scene("sensors.force_torque.bias", "[" + text + "]");
    }
    if (d_.force_drift > 0) set_scene("sensors.force_torque.force.drift", text_of(d_.force_drift));
    if (d_.torque_drift > 0)
      set_scene("sensors.force_torque.torque.drift", text_of(d_.torque_drift));
    if (d_.delay > 0)
      set_scene("sensors.force_torque.delay", text_of(scene_.sensors.force_torque.timing.delay +
                                                      half("force-torque delay", "s", d_.delay)));
  }

  void camera() {
    if (!scene_.camera) return;
    if (d_.camera.position > 0 || d_.camera.angle_deg > 0)
      set_pose("sensors.camera.calibration_error", "camera", d_.camera);
    if (d_.camera_noise > 0) set_scene("sensors.camera.depth.noise", text_of(d_.camera_noise));
  }

  /// Bounds on a face follow it; the others stay where hand and rig are.
  object::Box on_faces(object::Box box, const Vector3d& size) const {
    const Vector3d &lower = scene_.plant.origin, upper = lower + scene_.plant.size;
    for (int axis = 0; axis < 3; ++axis)
      for (double* bound : {&box.lower[axis], &box.upper[axis]}) {
        if (std::abs(*bound - upper[axis]) < kOnFace) *bound = lower[axis] + size[axis];
      }
    return box;
  }

  void dimensions() {
    const object::PlantOptions& plant = scene_.plant;
    Vector3d factors = Vector3d::Ones();
    if (d_.dimensions > 0) factors += normals("dimension", "", d_.dimensions);
    const Vector3d size = plant.size.cwiseProduct(factors);
    // Only the inner bound of a grasp moves: a hand that holds the end holds it still.
    const double shift = d_.grasp > 0 ? normal("grasp on object", "m", d_.grasp) : 0;
    if (d_.dimensions > 0) {
      set_scene("object.size", text_of(size));
      if (plant.clamp) set_scene("object.clamp_box", text_of(on_faces(*plant.clamp, size)));
      move_points(factors);
    }
    constexpr const char* kKeys[] = {"object.grasp_box", "object.second_grasp_box"};
    for (std::size_t i = 0; i < plant.grasps.size(); ++i) {
      object::Box box = on_faces(plant.grasps[i].patch, size);
      const bool at_end = box.upper.x() == size.x();
      (at_end ? box.lower : box.upper).x() += shift;
      set_scene(kKeys[i], text_of(box));
    }
  }

  /// Pokes and markers stay on the material that they are on.
  void move_points(const Vector3d& factors) {
    for (std::size_t i = 0; i < scene_.pokes.size(); ++i)
      set_scene("pokes." + std::to_string(i) + ".point",
                text_of(Vector3d(scene_.pokes[i].point.cwiseProduct(factors))));
    if (!scene_.markers) return;
    std::string points;
    for (const Vector3d& point : scene_.markers->rest_points)
      points += (points.empty() ? "" : ", ") + text_of(Vector3d(point.cwiseProduct(factors)));
    set_scene("markers.rest_points", "[" + points + "]");
  }

  void pads() {
    if (d_.pads_factor == 1) return;
    const double factor =
        log_uniform("pads' stiffness factor", "", 1 / d_.pads_factor, d_.pads_factor);
    set_scene("object.pads.stiffness", text_of(factor * scene_.plant.grasps[0].stiffness));
  }

  /// Where palpated believes the clamp and the hand on the unloaded object to be. Along x an error
  /// of the clamp alone would be a strain that the hand's first pose shows: the rest pose follows.
  void clamp_and_grasp() {
    const config::Node object = section(configuration_, "object");
    Vector3d clamp = Vector3d::Zero(), grasp = Vector3d::Zero();
    if (d_.clamp > 0 && object.has("fixed_box")) {
      clamp = normals("clamp", "m", d_.clamp);
      const math::Pose X_WO = section(configuration_, "frames").pose("object_in_base");
      set_daemon("frames.object_in_base.position", text_of(Vector3d(X_WO * clamp)));
    }
    if (!object.has("grasp_at_rest")) return;
    if (d_.grasp > 0) grasp = normals("grasp at rest", "m", d_.grasp);
    grasp.x() -= clamp.x();
    if (grasp.isZero(0)) return;
    set_daemon("object.grasp_at_rest.position",
               text_of(Vector3d(object.pose("grasp_at_rest").translation() + grasp)));
  }

  void material() {
    const config::Node material = section(configuration_, "object.material");
    const auto scale = [&](const char* key, double factor) {
      set_daemon(std::string("object.material.") + key, text_of(factor * material.number(key, {})));
    };
    if (d_.young_modulus > 0 && material.has("young_modulus"))
      scale("young_modulus", std::exp(normal("log E", "", d_.young_modulus)));
    if (d_.density > 0 && material.has("density"))
      scale("density", 1 + normal("density", "", d_.density));
    if (d_.poisson_ratio > 0 && material.has("poisson_ratio")) poisson_ratio(material);
    if (scene_.soft_box) return;
    if (d_.creep > 0) creep();
    if (d_.uneven > 0) uneven_stiffness();
  }

  void uneven_stiffness() {
    constexpr std::uint64_t kSeeds = 1000000000;
    const std::string name = "uneven stiffness";
    const std::uint64_t seed =
        math::Random(sample_.seed(), name + " " + std::to_string(index_ + 1)).below(kSeeds);
    drawn(name + ", seed", "", static_cast<double>(seed));
    set_scene("object.stiffness_field", "{deviation: " + text_of(d_.uneven) +
                                            ", length: " + text_of(d_.uneven_length) +
                                            ", seed: " + std::to_string(seed) + "}");
  }

  /// Truncated to what elements of displacements can represent as well.
  void poisson_ratio(const config::Node& material) {
    const double nu = material.number("poisson_ratio", {}), deviation = d_.poisson_ratio;
    const double lower = std::max(-d_.truncated_at, (kLeastPoisson - nu) / deviation),
                 upper = std::min(d_.truncated_at, (kMostPoisson - nu) / deviation);
    if (lower >= upper) return;
    const double change = deviation * truncated_normal(share("Poisson's ratio"), lower, upper);
    set_daemon("object.material.poisson_ratio", text_of(nu + drawn("Poisson's ratio", "", change)));
  }

  void creep() {
    const double modulus = std::max(1e-6, half("creep, relative modulus", "", d_.creep));
    const double time = log_uniform("creep, time", "s", d_.creep_time[0], d_.creep_time[1]);
    set_scene("object.material.maxwell", "[{relative_modulus: " + text_of(modulus) +
                                             ", relaxation_time: " + text_of(time) + "}]");
  }

  void gravity() {
    if (d_.gravity_deg == 0) return;
    const Vector3d gravity =
        section(configuration_, "frames").vector3("gravity_in_base", {}, Vector3d(0, 0, -9.81));
    const double about_x = normal("gravity about x", "deg", d_.gravity_deg),
                 about_y = normal("gravity about y", "deg", d_.gravity_deg);
    const Vector3d turn = kDegree * Vector3d(about_x, about_y, 0);
    set_daemon("frames.gravity_in_base", text_of(Vector3d(math::exp_rotation(turn) * gravity)));
  }

  void payload() {
    if (d_.payload_mass == 0 && d_.payload_center == 0) return;
    const std::vector<config::Node> sensing = configuration_.list("sensing");
    for (std::size_t i = 0; i < sensing.size(); ++i) {
      if (!sensing[i].is_mapping("payload")) continue;
      const config::Node payload = sensing[i].child("payload");
      const std::string key = "sensing." + std::to_string(i) + ".payload.";
      const double factor = 1 + normal("payload mass", "", d_.payload_mass);
      set_daemon(key + "mass", text_of(factor * payload.number("mass", {})));
      const Vector3d center = payload.vector3("center_of_mass", {}, Vector3d::Zero());
      set_daemon(key + "center_of_mass",
                 text_of(Vector3d(center + normals("payload center", "m", d_.payload_center))));
      return;  // a second arm has its own identification
    }
  }

  void mesh() {
    const config::Node box = section(configuration_, "object.mesh.box");
    if (d_.mesh_factors.empty() || !box.has("cells")) return;
    const std::size_t count = d_.mesh_factors.size();
    const double factor = drawn(
        "mesh, factor of cells", "",
        d_.mesh_factors[static_cast<std::size_t>(share("mesh") * static_cast<double>(count))]);
    Vector3d cells = box.vector3("cells");
    for (double& number : cells) number = std::max(1.0, std::round(factor * number));
    set_daemon("object.mesh.box.cells", text_of(cells));
  }

  const Distributions& d_;
  const LatinHypercube& sample_;
  const int index_;
  const scenes::Scene scene_;
  const config::Node configuration_;
  runs::Mismatch level_;
};

}  // namespace

runs::Mismatch draw_mismatch(const Distributions& distributions, const LatinHypercube& sample,
                             int index, const std::filesystem::path& scene,
                             const std::filesystem::path& configuration) {
  return Draw(distributions, sample, index, scene, configuration).level();
}

}  // namespace palpate::uncertainty
