#pragma once

#include <atomic>
#include <palpate/biotac_t.hpp>
#include <palpate/contacts_t.hpp>
#include <palpate/health_t.hpp>
#include <palpate/shape_mesh_t.hpp>
#include <palpate/shape_t.hpp>
#include <thread>

#include "rt/bus/authentication.hpp"
#include "rt/bus/message_bus.hpp"
#include "rt/bus/session.hpp"

namespace palpate {

/// Publishes a box of five tetrahedra whose true shape is offset by 1 and 3 mm from the estimate at
/// alternate nodes, a fingertip with contact at E10, and HEALTH, until it is destroyed.
class Scene {
 public:
  static constexpr double kSide = 0.1;  // m
  static constexpr int kTouched = 10;   // electrode
  static constexpr int kTouch = 150;    // counts

  Scene(const std::string& control, const std::string& housekeeping)
      : thread_([this, control, housekeeping] { publish(control, housekeeping); }) {}
  ~Scene() {
    stop_ = true;
    thread_.join();
  }
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;

 private:
  static shape_mesh_t mesh() {
    shape_mesh_t mesh{};
    mesh.mesh_hash = 77;
    mesh.chunks = 1;
    mesh.corner_count = 8;
    for (int i = 0; i < 8; ++i) {
      for (int axis = 0; axis < 3; ++axis)
        mesh.rest_xyz.push_back((i >> axis & 1) != 0 ? static_cast<float>(kSide) : 0);
    }
    mesh.element_size = 4;
    mesh.elements = {0, 1, 2, 4, 3, 2, 1, 7, 5, 1, 4, 7, 6, 4, 2, 7, 1, 2, 4, 7};
    mesh.triangles = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                      2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
    mesh.constrained = {0, 2};
    mesh.rest_xyz_count = static_cast<std::int32_t>(mesh.rest_xyz.size());
    mesh.element_index_count = static_cast<std::int32_t>(mesh.elements.size());
    mesh.triangle_index_count = static_cast<std::int32_t>(mesh.triangles.size());
    mesh.constrained_count = static_cast<std::int32_t>(mesh.constrained.size());
    return mesh;
  }
  /// Moved by `x` to the right, the upper side bent further.
  static shape_t shape(const shape_mesh_t& mesh, double x) {
    shape_t shape{};
    shape.mesh_hash = mesh.mesh_hash;
    shape.node_count = mesh.corner_count;
    shape.xyz = mesh.rest_xyz;
    shape.xyz_count = mesh.rest_xyz_count;
    for (int i = 0; i < shape.node_count; ++i) {
      const double bend = (i >> 1 & 1) != 0 ? 0.03 : 0;
      shape.xyz[static_cast<std::size_t>(3 * i)] += static_cast<float>(x + bend);
    }
    return shape;
  }

  void publish(const std::string& control_url, const std::string& housekeeping_url) {
    const auto control = bus::make_lcm_bus(control_url);
    const auto housekeeping = bus::make_lcm_bus(housekeeping_url);
    bus::TypedPublisher<biotac_t> fingertips(*control, "BIOTAC_2");
    bus::TypedPublisher<contacts_t> touches(*control, "CONTACTS");
    bus::TypedPublisher<shape_t> shapes(*housekeeping, "SHAPE");
    bus::TypedPublisher<shape_t> truths(*housekeeping, "TRUTH_SHAPE");
    bus::TypedPublisher<shape_mesh_t> meshes(*housekeeping, "SHAPE_MESH");
    bus::TypedPublisher<shape_mesh_t> true_meshes(*housekeeping, "TRUTH_MESH");
    bus::TypedPublisher<health_t> healths(*housekeeping, "HEALTH");
    shape_mesh_t box = mesh();
    shape_t estimate = shape(box, 0.01), truth = shape(box, 0.01);
    for (int i = 0; i < truth.node_count; ++i)
      truth.xyz[static_cast<std::size_t>(3 * i)] += i % 2 == 0 ? 1e-3f : 3e-3f;
    biotac_t fingertip{};
    contacts_t touch{};
    touch.count = 1;
    touch.location[0][0] = touch.location[0][1] = 0.05;
    touch.wrench[0][0] = 1;
    health_t health{};
    bus::HeaderStamper stamp(5);
    for (int i = 0; !stop_; ++i) {
      const auto send = [&](auto& publisher, auto& message) {
        stamp.put(message, bus::wall_clock_us());
        publisher.publish(message);
      };
      // Contact during odd seconds, so that taring between them makes it visible.
      for (auto& counts : fingertip.electrodes) counts = static_cast<std::int16_t>(2000 + i % 3);
      if (i / 100 % 2 == 1) fingertip.electrodes[kTouched - 1] += kTouch;
      fingertip.valid = 15;
      send(fingertips, fingertip);
      send(touches, touch);
      send(truths, truth);
      send(shapes, estimate);
      if (i % 20 == 0) {
        send(meshes, box);
        send(true_meshes, box);
        send(healths, health);
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }

  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace palpate
