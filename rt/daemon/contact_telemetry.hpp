#pragma once

#include <array>
#include <palpate/contacts_t.hpp>

#include "rt/bus/stamped_publisher.hpp"
#include "rt/pipeline/pipeline.hpp"

namespace palpate::daemon {

/// Publishes CONTACTS: those that sensors report, and those with obstacles that the model predicts.
class ContactTelemetry {
 public:
  ContactTelemetry(bus::MessageBus& control, std::int64_t session);

  void publish(const pipeline::Pipeline& pipeline, std::int64_t utime) noexcept;

 private:
  void put_predicted(const std::vector<elasticity::SurfaceContact>& contacts) noexcept;

  bus::StampedPublisher<contacts_t> contacts_;
  contacts_t message_{};
  /// The pressing contacts with the largest normal forces, largest first.
  std::array<const elasticity::SurfaceContact*, contacts_t::MOST_PREDICTED> largest_{};
};

}  // namespace palpate::daemon
