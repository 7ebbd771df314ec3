#pragma once

#include <array>
#include <palpate/contacts_t.hpp>
#include <palpate/obstacles_t.hpp>

#include "rt/bus/stamped_publisher.hpp"
#include "rt/pipeline/pipeline.hpp"

namespace palpate::daemon {

/// Publishes CONTACTS: those that sensors report, and those with obstacles that the model predicts;
/// and OBSTACLES, every 10 ms.
class ContactTelemetry {
 public:
  ContactTelemetry(bus::MessageBus& control, std::int64_t session);

  void publish(const pipeline::Pipeline& pipeline, std::int64_t utime) noexcept;

 private:
  void publish_obstacles(const pipeline::Pipeline& pipeline, std::int64_t utime) noexcept;
  void put_predicted(const std::vector<elasticity::SurfaceContact>& contacts) noexcept;

  bus::StampedPublisher<contacts_t> contacts_;
  bus::StampedPublisher<obstacles_t> obstacles_;
  contacts_t message_{};
  obstacles_t poses_{};
  /// The pressing contacts with the largest normal forces, largest first.
  std::array<const elasticity::SurfaceContact*, contacts_t::MOST_PREDICTED> largest_{};
};

}  // namespace palpate::daemon
