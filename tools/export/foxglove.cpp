#include "tools/export/foxglove.hpp"

#include <cmath>
#include <cstring>

#include "sim/draw/annotate.hpp"
#include "tools/common/base64.hpp"
#include "tools/export/element_gradients.hpp"
#include "tools/export/json_schema.hpp"
#include "tools/export/predicted_contact.hpp"

namespace palpate::exporting {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kLineList = 2;  // LineType of foxglove.LinePrimitive
constexpr int kFloat32 = 7;   // NumericType of foxglove.PackedElementField
constexpr double kMetresPerNewton = 0.05;
constexpr double kSmallestForce = 0.02;  // N

Json time_of(std::int64_t utime) {
  return {{"sec", utime / 1'000'000}, {"nsec", utime % 1'000'000 * 1000}};
}

Json vector_of(const Eigen::Vector3d& v) { return {{"x", v.x()}, {"y", v.y()}, {"z", v.z()}}; }

Json quaternion_of(const Eigen::Quaterniond& q) {
  return {{"x", q.x()}, {"y", q.y()}, {"z", q.z()}, {"w", q.w()}};
}

Json pose_of(const Eigen::Vector3d& p,
             const Eigen::Quaterniond& q = Eigen::Quaterniond::Identity()) {
  return {{"position", vector_of(p)}, {"orientation", quaternion_of(q)}};
}

Json colour_of(const draw::Colour& c) {
  const auto rounded = [](float value) { return std::round(1e3 * value) / 1e3; };
  return {{"r", rounded(c.red)}, {"g", rounded(c.green)}, {"b", rounded(c.blue)}, {"a", c.alpha}};
}

/// Rounded to a micrometre: further digits would make up most of the file.
Json points_of(const Eigen::Matrix3Xd& points) {
  Json list = Json::array();
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    list.push_back(vector_of((1e6 * points.col(i)).array().round() / 1e6));
  return list;
}

/// Every list must be present, since Foxglove reads the length of each.
Json empty_entity(const std::string& id, std::int64_t utime) {
  Json entity = {{"timestamp", time_of(utime)},
                 {"frame_id", "O"},
                 {"id", id},
                 {"lifetime", {{"sec", 0}, {"nsec", 0}}},
                 {"frame_locked", true}};
  for (const char* list : {"metadata", "arrows", "cubes", "spheres", "cylinders", "lines",
                           "triangles", "texts", "models"})
    entity[list] = Json::array();
  return entity;
}

std::string scene(const Json& entity) {
  return Json{{"deletions", Json::array()}, {"entities", Json::array({entity})}}.dump();
}

void add_arrow(Json& entity, const double* location, const double* wrench,
               const draw::Colour& colour) {
  const Eigen::Map<const Eigen::Vector3d> at(location), force(wrench);
  if (!(force.norm() > kSmallestForce)) return;
  const double length = kMetresPerNewton * force.norm();
  const Eigen::Quaterniond along =
      Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitX(), force);
  entity["arrows"].push_back({{"pose", pose_of(at, along)},
                              {"shaft_length", 0.8 * length},
                              {"shaft_diameter", 0.006},
                              {"head_length", 0.2 * length},
                              {"head_diameter", 0.014},
                              {"color", colour_of(colour)}});
}

void add_ball(Json& entity, const double* at, double radius, const draw::Colour& colour) {
  entity["spheres"].push_back({{"pose", pose_of(Eigen::Map<const Eigen::Vector3d>(at))},
                               {"size", vector_of(Eigen::Vector3d::Constant(2 * radius))},
                               {"color", colour_of(colour)}});
}

void add_feature(Json& entity, const feature_t& feature) {
  const auto* kind = reinterpret_cast<const char*>(feature.kind);
  const bool is_point = std::strncmp(kind, "point", sizeof feature.kind) == 0;
  const bool is_pose = std::strncmp(kind, "pose", sizeof feature.kind) == 0;
  if ((!is_point && !is_pose) || feature.value_count < 3) return;
  add_ball(entity, feature.value, 0.008, {0.1F, 0.6F, 0.2F, 1});
  if (feature.revision >= 0) add_ball(entity, feature.target, 0.010, {0.8F, 0.05F, 0.45F, 1});
}

}  // namespace

std::string estimate_scene(const Instant& instant, double largest) {
  Json entity = empty_entity("estimate", instant.utime);
  const log::MeshMessage& mesh = instant.estimate_mesh->mesh();
  Json colours = Json::array();
  for (Eigen::Index i = 0; i < instant.estimate.cols(); ++i) {
    const double share =
        (instant.estimate.col(i) - mesh.nodes.col(i)).norm() / std::max(largest, 1e-9);
    colours.push_back(colour_of(draw::colour_map(share)));
  }
  Json indices = Json::array();
  for (Eigen::Index i = 0; i < mesh.triangles.size(); ++i)
    indices.push_back(mesh.triangles.data()[i]);
  entity["triangles"].push_back({{"pose", pose_of(Eigen::Vector3d::Zero())},
                                 {"points", points_of(instant.estimate)},
                                 {"color", colour_of({1, 1, 1, 1})},
                                 {"colors", colours},
                                 {"indices", indices}});
  if (instant.contacts) {
    for (int i = 0; i < std::min(instant.contacts->count, 8); ++i)
      add_arrow(entity, instant.contacts->location[i], instant.contacts->wrench[i],
                {0.9F, 0.35F, 0.05F, 1});
    for (int i = 0; i < predicted_count(*instant.contacts); ++i) {
      const PredictedContact contact = predicted_contact(*instant.contacts, i);
      add_arrow(entity, contact.place.data(), contact.force.data(), {0.1F, 0.6F, 0.6F, 1});
    }
  }
  if (instant.estimated)
    add_arrow(entity, instant.estimated->unknown_contact_location,
              instant.estimated->unknown_contact_force, {0.55F, 0.15F, 0.75F, 1});
  if (instant.feature) add_feature(entity, *instant.feature);
  return scene(entity);
}

std::string truth_scene(const Instant& instant) {
  Json entity = empty_entity("truth", instant.utime);
  const Eigen::Matrix2Xi edges = surface_edges(instant.truth_mesh->mesh(), Edges::kAll);
  Eigen::Matrix3Xd points(3, 2 * edges.cols());
  for (Eigen::Index e = 0; e < edges.cols(); ++e) {
    points.col(2 * e) = instant.truth.col(edges(0, e));
    points.col(2 * e + 1) = instant.truth.col(edges(1, e));
  }
  entity["lines"].push_back({{"type", kLineList},
                             {"pose", pose_of(Eigen::Vector3d::Zero())},
                             {"thickness", 2},
                             {"scale_invariant", true},
                             {"points", points_of(points)},
                             {"color", colour_of({0.86F, 0.1F, 0.1F, 1})},
                             {"colors", Json::array()},
                             {"indices", Json::array()}});
  return scene(entity);
}

std::string flange_pose(const robot_state_t& state, std::int64_t utime) {
  const Eigen::Quaterniond q(state.quaternion[0], state.quaternion[1], state.quaternion[2],
                             state.quaternion[3]);
  return Json{{"timestamp", time_of(utime)},
              {"frame_id", "W"},
              {"pose", pose_of(Eigen::Map<const Eigen::Vector3d>(state.position), q)}}
      .dump();
}

std::string flange_transform(const robot_state_t& state, std::int64_t utime) {
  const Eigen::Quaterniond q(state.quaternion[0], state.quaternion[1], state.quaternion[2],
                             state.quaternion[3]);
  return Json{{"timestamp", time_of(utime)},
              {"parent_frame_id", "W"},
              {"child_frame_id", "E"},
              {"translation", vector_of(Eigen::Map<const Eigen::Vector3d>(state.position))},
              {"rotation", quaternion_of(q)}}
      .dump();
}

std::string object_transform(const math::Pose& X_WO, std::int64_t utime) {
  return Json{{"timestamp", time_of(utime)},
              {"parent_frame_id", "W"},
              {"child_frame_id", "O"},
              {"translation", vector_of(X_WO.translation())},
              {"rotation", quaternion_of(Eigen::Quaterniond(X_WO.linear()))}}
      .dump();
}

std::string point_cloud(const log::Record& observation, std::int64_t utime) {
  const int field = observation.type().field("points");
  std::vector<float> points;
  for (int i = 0; i < observation.used(field); ++i)
    points.push_back(static_cast<float>(observation.number(field, i)));
  const std::string data = common::to_base64(points.data(), points.size() * sizeof(float));
  Json fields = Json::array();
  for (const auto& [name, offset] : {std::pair{"x", 0}, {"y", 4}, {"z", 8}})
    fields.push_back({{"name", name}, {"offset", offset}, {"type", kFloat32}});
  return Json{
      {"timestamp", time_of(utime)}, {"frame_id", "W"},  {"pose", pose_of(Eigen::Vector3d::Zero())},
      {"point_stride", 12},          {"fields", fields}, {"data", data}}
      .dump();
}

}  // namespace palpate::exporting
