#include "tools/view/scene.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <palpate/channels.hpp>

#include "core/math/rigid.hpp"
#include "rt/bus/text.hpp"

namespace palpate::view {
namespace {

constexpr std::string_view kMeshes[] = {channel::kShapeMesh, channel::kTruthMesh};

template <class Numbers>
bool all_finite(const Numbers& numbers) {
  return std::all_of(std::begin(numbers), std::end(numbers),
                     [](auto x) { return std::isfinite(x) && std::fabs(x) < 1e9; });
}

bool is_sound(const contacts_t& m) {
  if (m.count < 0 || m.count > contacts_t::MOST || m.obstacle_count < 0 ||
      m.obstacle_count > contacts_t::MOST_OBSTACLES || m.predicted_count < 0 ||
      m.predicted_count > contacts_t::MOST_PREDICTED)
    return false;
  return std::all_of(m.predicted_obstacle, m.predicted_obstacle + m.predicted_count,
                     [&](int obstacle) { return obstacle >= 0 && obstacle < m.obstacle_count; });
}
bool is_sound(const obstacles_t& m) { return m.count >= 0 && m.count <= obstacles_t::MOST; }
bool is_sound(const estimate_t& m) { return m.grasp_count >= 0 && m.grasp_count <= 2; }
bool is_sound(const discrepancy_t& m) {
  return m.grasp_count >= 0 && m.grasp_count <= 2 && m.cause_count >= 0 &&
         m.cause_count <= static_cast<int>(std::size(m.cause)) && all_finite(m.probability) &&
         std::isfinite(m.duration) && std::isfinite(m.test) && std::isfinite(m.threshold);
}
bool is_sound(const feature_t& m) {
  return m.value_count >= 0 && m.value_count <= 32 && m.error_count >= 0 && m.error_count <= 32;
}
bool is_sound(const health_t& m) {
  return m.phase_count >= 0 && m.phase_count <= kPhases && m.input_count >= 0 &&
         m.input_count <= 16 && m.model_count >= 0 && m.model_count <= 12;
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
bool is_sound(const world_state_t& m) {
  return *bus::get_text(m.name) != '\0' && all_finite(m.position) &&
         math::is_unit_quaternion(m.quaternion);
}
bool is_sound(const biotac_t& m) {
  return m.pac_count >= 0 && m.pac_count <= static_cast<int>(std::size(m.pac));
}

}  // namespace

double error_norm(const feature_t& feature) {
  if (feature.revision < 0) return std::numeric_limits<double>::quiet_NaN();
  double sum = 0;
  for (int i = 0; i < feature.error_count; ++i) sum += feature.error[i] * feature.error[i];
  return std::sqrt(sum);
}

bool LatestShape::take(shape_t&& chunk, std::int64_t arrival_us) {
  const std::int64_t rejected = assembler.rejected();
  const bool is_finite = all_finite(chunk.xyz);
  shape_t* whole = is_finite ? assembler.add(std::move(chunk)) : nullptr;
  if (whole == nullptr) return is_finite && assembler.rejected() == rejected;
  std::swap(message, *whole);
  time_us = arrival_us;
  there = true;
  ++count;
  return true;
}

void Fingertip::take(const biotac_t& next, std::int64_t next_us) {
  const bool follows = there && next.session == message.session &&
                       next.seq == std::int64_t{message.seq} + 1 &&
                       (next.valid & biotac_t::VALID_PAC) != 0;
  if (!follows) pac.clear();
  if ((next.valid & biotac_t::VALID_PAC) != 0)
    pac.insert(pac.end(), next.pac, next.pac + next.pac_count);
  if (pac.size() > kMostPac) pac.erase(pac.begin(), pac.end() - kMostPac);
  message = next;
  time_us = next_us;
  there = true;
}

template <class Visit>
void Scene::for_each_latest(Visit visit) {
  visit(truth_contact), visit(contacts), visit(obstacles), visit(estimate), visit(discrepancy);
  visit(feature), visit(health), visit(config), visit(twist), visit(manual), visit(observation);
  for (auto& one : robot) visit(one);
  for (auto& one : hand) visit(one);
}

bool Scene::is_mesh(std::string_view channel) {
  return channel == kMeshes[0] || channel == kMeshes[1];
}

const std::vector<std::string_view>& Scene::channels() {
  static const std::vector<std::string_view> names = [] {
    std::vector<std::string_view> all{kEvents, kMeshes[0], kMeshes[1], channel::kWorldState};
    Scene scene;
    all.insert(all.end(), {scene.shape.channel, scene.truth.channel});
    scene.for_each_latest([&all](const auto& latest) { all.emplace_back(latest.channel); });
    for (const Fingertip& fingertip : scene.fingertips) all.emplace_back(fingertip.channel);
    return all;
  }();
  return names;
}

bool Scene::accept(std::string_view channel, const void* data, int size, std::int64_t time_us) {
  if (channel == kEvents) {
    component_event_t event;
    if (!bus::decode(event, data, size)) {
      ++rejected_;
      return true;
    }
    events_.push_back({++event_count_, time_us, event});
    if (events_.size() > kMostEvents) events_.pop_front();
    return true;
  }
  for (LatestShape* latest : {&shape, &truth}) {
    if (channel != latest->channel) continue;
    shape_t chunk;
    if (!bus::decode(chunk, data, size) || !latest->take(std::move(chunk), time_us)) ++rejected_;
    return true;
  }
  if (is_mesh(channel)) {
    shape_mesh_t chunk;
    if (bus::decode(chunk, data, size))
      meshes_.add(chunk);
    else
      ++rejected_;
    return true;
  }
  for (Fingertip& fingertip : fingertips) {
    if (channel != fingertip.channel) continue;
    biotac_t message;
    if (bus::decode(message, data, size) && is_sound(message))
      fingertip.take(message, time_us);
    else
      ++rejected_;
    return true;
  }
  if (channel == channel::kWorldState) {
    world_state_t message;
    if (bus::decode(message, data, size) && is_sound(message))
      take(message, time_us);
    else
      ++rejected_;
    return true;
  }
  bool is_shown = false;
  for_each_latest([&](auto& latest) {
    if (channel != latest.channel) return;
    is_shown = true;
    const auto* bytes = static_cast<const std::uint8_t*>(data);
    latest.data.assign(bytes, bytes + size);
    latest.time_us = time_us;
    latest.fresh = true;
  });
  return is_shown || described_.take(0, channel, data, size, time_us);
}

void Scene::take(const world_state_t& message, std::int64_t time_us) {
  const std::string name = bus::get_text(message.name);
  if (moved_.size() >= kMostMoved && moved_.count(name) == 0) {
    const auto oldest = std::min_element(
        moved_.begin(), moved_.end(),
        [](const auto& a, const auto& b) { return a.second.time_us < b.second.time_us; });
    moved_.erase(oldest);
  }
  moved_[name] = {time_us, message};
}

const MovedObstacle* Scene::moved(const std::string& name) const {
  const auto at = moved_.find(name);
  return at == moved_.end() ? nullptr : &at->second;
}

void Scene::refresh() {
  for_each_latest([this](auto& latest) {
    if (!latest.fresh) return;
    latest.fresh = false;
    typename std::decay_t<decltype(latest)>::Type message;
    const bool whole =
        bus::decode(message, latest.data.data(), static_cast<int>(latest.data.size()));
    if (!whole || !is_sound(message)) {
      ++rejected_;
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
  shape.there = truth.there = false;
  for (Fingertip& fingertip : fingertips) {
    fingertip.there = false;
    fingertip.pac.clear();
  }
  moved_.clear();
  described_.clear();
  events_.clear();
  ++generation_;
}

}  // namespace palpate::view
