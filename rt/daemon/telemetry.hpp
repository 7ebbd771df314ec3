#pragma once

#include <memory>
#include <palpate/config_t.hpp>
#include <palpate/estimate_t.hpp>
#include <palpate/feature_t.hpp>
#include <palpate/joint_velocity_command_t.hpp>
#include <palpate/twist_command_t.hpp>
#include <palpate/unknown_contact_t.hpp>
#include <vector>

#include "rt/bus/authentication.hpp"
#include "rt/bus/message_bus.hpp"
#include "rt/bus/session.hpp"
#include "rt/bus/shape_chunks.hpp"
#include "rt/daemon/contact_telemetry.hpp"
#include "rt/daemon/discrepancy_telemetry.hpp"
#include "rt/daemon/wrench_telemetry.hpp"
#include "rt/pipeline/pipeline.hpp"
#include "rt/registry/object.hpp"

namespace palpate::daemon {

/// Publishes SHAPE and SHAPE_MESH of one mesh; owns everything whose size depends on it. Allocates
/// in the constructor only.
class MeshTelemetry {
 public:
  MeshTelemetry(bus::MessageBus& housekeeping, const registry::Object& object);

  /// `age_us`: age of the shape.
  void publish_shape(const pipeline::Pipeline& pipeline, std::int64_t age_us,
                     bus::HeaderStamper& stamp, std::int64_t utime) noexcept;
  /// Publishes one chunk of SHAPE_MESH; the next call publishes the next one.
  void publish_mesh_chunk(bus::HeaderStamper& stamp, std::int64_t utime) noexcept {
    mesh_.publish_chunk(stamp, utime);
  }
  int mesh_chunks() const noexcept { return mesh_.chunks(); }

 private:
  bus::ShapePublisher shape_;
  bus::MeshPublisher mesh_;
};

/// Publishes the daemon's messages on shape and control; of a pipeline without an object only the
/// compensated wrenches, and no commands. Buffers are sized by the constructor; nothing allocates
/// afterwards.
class Telemetry {
 public:
  Telemetry(bus::MessageBus& control, bus::MessageBus& housekeeping,
            const pipeline::Pipeline& pipeline, std::int64_t session,
            const bus::Access& access = {});

  /// Each cycle, on the control bus: TWIST_COMMAND, or JOINT_VELOCITY_COMMAND if the gate outputs
  /// joint velocities. `arm`: 0, or 1 if the pipeline has a second one.
  void publish_command(int arm, const control::GateOutput& gate, bool valid,
                       std::int64_t utime) noexcept;
  void publish_state(const pipeline::Pipeline& pipeline, std::int64_t utime) noexcept;
  /// At the rate of SHAPE. `age_us`: age of the shape.
  void publish_shape(const pipeline::Pipeline& pipeline, std::int64_t age_us,
                     std::int64_t utime) noexcept {
    mesh_->publish_shape(pipeline, age_us, shape_stamp_, utime);
  }
  /// Publishes one chunk of SHAPE_MESH; the next call publishes the next one.
  void publish_mesh_chunk(std::int64_t utime) noexcept {
    mesh_->publish_mesh_chunk(mesh_stamp_, utime);
  }
  int mesh_chunks() const noexcept { return mesh_ ? mesh_->mesh_chunks() : 0; }

  /// Call after components of the pipeline have been replaced; with the messages of its new mesh,
  /// which are exchanged for those of the old one.
  void take(const pipeline::Pipeline& pipeline) noexcept;
  void take(std::unique_ptr<MeshTelemetry>& mesh) noexcept { mesh_.swap(mesh); }

 private:
  /// TWIST_COMMAND or JOINT_VELOCITY_COMMAND of one arm.
  template <class Message>
  struct Command {
    Command(bus::MessageBus& control, const char* channel, std::int64_t session,
            const bus::Access& access)
        : stamp(session), sealer(channel, access), publisher(control, channel) {}
    void publish(int arm, bool valid, std::int64_t utime) noexcept {
      stamp.put(message, utime);
      message.grasp = arm;
      message.valid = valid ? 1 : 0;
      sealer.put(message, utime);
      publisher.publish(message);
    }
    bus::HeaderStamper stamp;
    bus::MessageSigner sealer;
    bus::TypedPublisher<Message> publisher;
    Message message{};
  };

  void publish_unknown_contact(const estimation::UnknownContact& contact,
                               std::int64_t utime) noexcept;

  std::vector<Command<twist_command_t>> commands_;             // by arm
  std::unique_ptr<Command<joint_velocity_command_t>> joints_;  // of the first arm, if modelled
  bool publishes_joints_ = false;
  bus::HeaderStamper unknown_stamp_, estimate_stamp_, feature_stamp_, shape_stamp_, mesh_stamp_;
  WrenchTelemetry wrenches_;
  ContactTelemetry contacts_;
  bus::TypedPublisher<unknown_contact_t> unknown_;
  bus::TypedPublisher<estimate_t> estimate_;
  bus::TypedPublisher<feature_t> feature_;

  unknown_contact_t unknown_message_{};
  estimate_t estimate_message_{};
  feature_t feature_message_{};
  DiscrepancyTelemetry discrepancy_;
  std::unique_ptr<MeshTelemetry> mesh_;
};

}  // namespace palpate::daemon
