#pragma once

#include <palpate/config_t.hpp>
#include <palpate/contacts_t.hpp>
#include <palpate/estimate_t.hpp>
#include <palpate/feature_t.hpp>
#include <palpate/shape_mesh_t.hpp>
#include <palpate/shape_t.hpp>
#include <palpate/twist_command_t.hpp>
#include <vector>

#include "rt/bus/message_bus.hpp"
#include "rt/bus/session.hpp"
#include "rt/component/pipeline.hpp"

namespace palpate::daemon {

/// The daemon's own messages about shape and control. Buffers are sized by the constructor; nothing
/// allocates afterwards.
class Telemetry {
 public:
  Telemetry(bus::MessageBus& control, bus::MessageBus& housekeeping,
            const component::Pipeline& pipeline, std::int64_t session);

  /// Each cycle, on the control bus. `arm`: 0, or 1 where the pipeline has a second one.
  void publish_command(int arm, const control::GateOutput& gate, bool valid,
                       std::int64_t utime) noexcept;
  void publish_state(const component::Pipeline& pipeline, std::int64_t utime) noexcept;
  /// At the rate of SHAPE. `age_us`: how old the shape is.
  void publish_shape(component::Pipeline& pipeline, std::int64_t age_us,
                     std::int64_t utime) noexcept;
  /// One chunk of SHAPE_MESH; call again for the next one.
  void publish_mesh_chunk(std::int64_t utime) noexcept;
  int mesh_chunks() const noexcept { return static_cast<int>(mesh_.size()); }

 private:
  void prepare_mesh(const component::Pipeline& pipeline);

  /// TWIST_COMMAND of one arm.
  struct Command {
    Command(bus::MessageBus& control, const char* channel, std::int64_t session)
        : stamp(session), publisher(control, channel) {}
    bus::Stamp stamp;
    bus::TypedPublisher<twist_command_t> publisher;
    std::int64_t counter = 0;
    twist_command_t message{};
  };

  std::vector<Command> commands_;  // by arm
  bus::Stamp contacts_stamp_, estimate_stamp_, feature_stamp_, shape_stamp_, mesh_stamp_;
  bus::TypedPublisher<contacts_t> contacts_;
  bus::TypedPublisher<estimate_t> estimate_;
  bus::TypedPublisher<feature_t> feature_;
  bus::TypedPublisher<shape_t> shape_;
  bus::TypedPublisher<shape_mesh_t> mesh_publisher_;

  contacts_t contacts_message_{};
  estimate_t estimate_message_{};
  feature_t feature_message_{};
  shape_t shape_message_{};
  std::vector<shape_mesh_t> mesh_;
  std::size_t next_chunk_ = 0;
};

}  // namespace palpate::daemon
