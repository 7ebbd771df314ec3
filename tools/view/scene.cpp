#include "tools/view/scene.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::view {
namespace {

constexpr std::string_view kEvents = "COMPONENT_EVENT";
constexpr std::string_view kMeshes[] = {"SHAPE_MESH", "TRUTH_MESH"};

template <class Numbers>
bool all_finite(const Numbers& numbers) {
  return std::all_of(std::begin(numbers), std::end(numbers),
                     [](auto x) { return std::isfinite(x) && std::fabs(x) < 1e9; });
}

bool is_sound(const shape_t& m) {
  return m.node_count >= 1 && m.xyz_count % 3 == 0 && m.xyz_count / 3 == m.node_count &&
         (m.deviation_count == 0 || m.deviation_count == m.node_count) && all_finite(m.xyz);
}
bool is_sound(const contacts_t& m) { return m.count >= 0 && m.count <= 8; }
bool is_sound(const estimate_t& m) { return m.grasp_count >= 0 && m.grasp_count <= 2; }
bool is_sound(const feature_t& m) {
  return m.value_count >= 0 && m.value_count <= 32 && m.error_count >= 0 && m.error_count <= 32;
}
bool is_sound(const health_t& m) {
  return m.phase_count >= 0 && m.phase_count <= 10 && m.input_count >= 0 && m.input_count <= 16 &&
         m.model_count >= 0 && m.model_count <= 12;
}
bool is_sound(const robot_state_t& m) {
  return m.joint_count >= 0 && m.joint_count <= 16 && all_finite(m.q) && all_finite(m.position) &&
         all_finite(m.quaternion);
}
bool is_sound(const hand_state_t& m) {
  return m.fingertip_count >= 0 && m.fingertip_count <= 5 && m.joint_count >= 0 &&
         m.joint_count <= 32 && all_finite(m.q);
}
bool is_sound(const shape_observation_t& m) { return m.count >= 0 && m.count <= 256; }
bool is_sound(const truth_contact_t& m) { return m.grasp_count >= 0 && m.grasp_count <= 2; }
bool is_sound(const manual_force_t& m) { return all_finite(m.force) && all_finite(m.rest_point); }
bool is_sound(const twist_command_t& m) { return all_finite(m.twist); }
bool is_sound(const config_t&) { return true; }

}  // namespace

template <class Visit>
void Scene::for_each_latest(Visit visit) {
  visit(shape), visit(truth), visit(truth_contact), visit(contacts), visit(estimate);
  visit(feature), visit(health), visit(config), visit(twist), visit(manual), visit(observation);
  for (auto& one : robot) visit(one);
  for (auto& one : hand) visit(one);
}

const std::vector<std::string_view>& Scene::channels() {
  static const std::vector<std::string_view> names = [] {
    std::vector<std::string_view> all{kEvents, kMeshes[0], kMeshes[1]};
    Scene().for_each_latest([&all](const auto& latest) { all.emplace_back(latest.channel); });
    return all;
  }();
  return names;
}

void Scene::accept(std::string_view channel, const void* data, int size, std::int64_t time_us) {
  if (channel == kEvents) {
    component_event_t event;
    if (!bus::checked_decode(event, data, size)) {
      ++refused_;
      return;
    }
    events_.push_back({++event_count_, time_us, event});
    if (events_.size() > kMostEvents) events_.pop_front();
    return;
  }
  if (channel == kMeshes[0] || channel == kMeshes[1]) {
    shape_mesh_t chunk;
    if (bus::checked_decode(chunk, data, size))
      meshes_.add(chunk);
    else
      ++refused_;
    return;
  }
  for_each_latest([&](auto& latest) {
    if (channel != latest.channel) return;
    const auto* bytes = static_cast<const std::uint8_t*>(data);
    latest.data.assign(bytes, bytes + size);
    latest.time_us = time_us;
    latest.fresh = true;
  });
}

void Scene::refresh() {
  for_each_latest([this](auto& latest) {
    if (!latest.fresh) return;
    latest.fresh = false;
    typename std::decay_t<decltype(latest)>::Type message;
    const bool whole =
        bus::checked_decode(message, latest.data.data(), static_cast<int>(latest.data.size()));
    if (!whole || !is_sound(message)) {
      ++refused_;
      return;
    }
    latest.message = std::move(message);
    latest.there = true;
    ++latest.count;
  });
}

void Scene::forget_messages() {
  for_each_latest([](auto& latest) {
    latest.there = false;
    latest.fresh = false;
  });
  events_.clear();
  ++generation_;
}

}  // namespace palpate::view
