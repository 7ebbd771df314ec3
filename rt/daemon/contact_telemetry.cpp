#include "rt/daemon/contact_telemetry.hpp"

#include <algorithm>
#include <palpate/channels.hpp>

#include "rt/bus/text.hpp"

namespace palpate::daemon {
namespace {

void put_vector(const Eigen::Vector3d& v, float (&out)[3]) noexcept {
  for (int i = 0; i < 3; ++i) out[i] = static_cast<float>(v[i]);
}

}  // namespace

static_assert(contacts_t::MOST_OBSTACLES == collision::kMostObstacles);
static_assert(obstacles_t::MOST == collision::kMostObstacles);

ContactTelemetry::ContactTelemetry(bus::MessageBus& control, std::int64_t session)
    : contacts_(control, channel::kContacts, session, bus::Urgency::kLater),
      obstacles_(control, channel::kObstacles, session, bus::Urgency::kLater) {}

void ContactTelemetry::publish(const pipeline::Pipeline& pipeline, std::int64_t utime) noexcept {
  const sensing::ContactSet& contacts = pipeline.contacts();
  message_.count = contacts.count;
  for (int i = 0; i < contacts.count; ++i) {
    const sensing::Contact& contact = contacts.contacts[i];
    message_.source[i] = static_cast<int>(contact.source);
    std::copy_n(contact.location.data(), 3, message_.location[i]);
    const math::Vector6d wrench = contact.wrench.vector();
    std::copy_n(wrench.data(), 6, message_.wrench[i]);
    message_.deviation[i] = contact.force_deviation;
  }
  const std::vector<std::string>& names = pipeline.obstacles().names();
  message_.obstacle_count = static_cast<int>(names.size());
  for (std::size_t i = 0; i < names.size(); ++i) bus::put_text(message_.obstacle_name[i], names[i]);
  put_predicted(pipeline.model().contacts());
  contacts_.publish(message_, utime);
  constexpr std::int64_t kPeriod = 10000;  // us
  if (!names.empty() && utime - poses_.utime >= kPeriod) publish_obstacles(pipeline, utime);
}

void ContactTelemetry::publish_obstacles(const pipeline::Pipeline& pipeline,
                                         std::int64_t utime) noexcept {
  const pipeline::ObstacleMotion& obstacles = pipeline.obstacles();
  const std::vector<std::string>& names = obstacles.names();
  poses_.count = static_cast<int>(names.size());
  for (std::size_t i = 0; i < names.size(); ++i) {
    bus::put_text(poses_.name[i], names[i]);
    const math::Pose X_WB = obstacles.X_WB(i);
    poses_.is_placed[i] = obstacles.placements()[i].is_known ? 1 : 0;
    std::copy_n(X_WB.translation().data(), 3, poses_.position[i]);
    math::wxyz_from_rotation(X_WB.linear(), poses_.quaternion[i]);
  }
  const estimation::Estimate& estimate = pipeline.estimate();
  for (std::size_t k = 0; k < obstacles.free_directions().size(); ++k) {
    const collision::FreeDirection& direction = obstacles.free_directions()[k];
    poses_.displacement[direction.obstacle][direction.axis] = estimate.obstacle_motion[k];
    poses_.deviation[direction.obstacle][direction.axis] = estimate.obstacle_deviation[k];
  }
  obstacles_.publish(poses_, utime);
}

void ContactTelemetry::put_predicted(
    const std::vector<elasticity::SurfaceContact>& contacts) noexcept {
  std::fill_n(message_.obstacle_force, contacts_t::MOST_OBSTACLES, 0.0F);
  int kept = 0, pressing = 0;
  for (const elasticity::SurfaceContact& contact : contacts) {
    if (!contact.presses()) continue;
    ++pressing;
    message_.obstacle_force[contact.obstacle] += static_cast<float>(contact.normal_force());
    const elasticity::SurfaceContact* next = &contact;
    for (int k = 0; k < kept; ++k) {
      if (next->normal_force() > largest_[k]->normal_force()) std::swap(next, largest_[k]);
    }
    if (kept < contacts_t::MOST_PREDICTED) largest_[kept++] = next;
  }
  message_.predicted_count = kept;
  message_.predicted_omitted = pressing - kept;
  for (int k = 0; k < kept; ++k) {
    const elasticity::SurfaceContact& contact = *largest_[k];
    const double force = contact.normal_force();
    message_.predicted_obstacle[k] = contact.obstacle;
    message_.predicted_slips[k] = contact.slips ? 1 : 0;
    put_vector(contact.position, message_.predicted_place[k]);
    put_vector(contact.normal, message_.predicted_normal[k]);
    message_.predicted_force[k] = static_cast<float>(force);
    put_vector(contact.force - force * contact.normal, message_.predicted_friction[k]);
  }
}

}  // namespace palpate::daemon
