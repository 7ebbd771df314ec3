#pragma once

#include <Eigen/Core>
#include <cstring>
#include <functional>

#include "tools/log/log_reader.hpp"

namespace palpate::scores {

/// Plant: one 27-node hexahedron [0, 0.4] x [0, 0.1] x [0, 0.2] m, its nodes in a shuffled order.
/// Estimate: a tetrahedron in it.
inline const Eigen::Array3d kBox(0.4, 0.1, 0.2);

using Deformation = std::function<Eigen::Vector3d(const Eigen::Vector3d& rest, double time)>;

inline Eigen::Matrix3Xd plant_rest() {
  Eigen::Matrix3Xd nodes(3, 27);
  for (int i = 0; i < 27; ++i) {
    const int k = (i * 10 + 4) % 27;  // a shuffle: 10 and 27 have no common factor
    nodes.col(i) = (Eigen::Array3d(k % 3, (k / 3) % 3, k / 9) / 2 * kBox).matrix();
  }
  return nodes;
}

inline Eigen::Matrix3Xd estimate_rest() {
  Eigen::Matrix3Xd nodes(3, 4);
  nodes << 0, 0.4, 0.1, 0.3, 0, 0.05, 0.1, 0.025, 0, 0.1, 0.15, 0.2;
  return nodes;
}

inline void put_positions(shape_t& shape, const Eigen::Matrix3Xd& points) {
  shape.chunks = 1;
  shape.node_count = static_cast<int>(points.cols());
  shape.xyz_count = 3 * shape.node_count;
  for (int i = 0; i < points.size(); ++i) shape.xyz.push_back(static_cast<float>(points.data()[i]));
}

/// Positions of points under `motion` at a time.
inline Eigen::Matrix3Xd moved(const Eigen::Matrix3Xd& rest, const Deformation& motion,
                              double time) {
  Eigen::Matrix3Xd points(3, rest.cols());
  for (int i = 0; i < rest.cols(); ++i) points.col(i) = motion(rest.col(i), time);
  return points;
}

inline shape_t shape_at(double time, const Eigen::Matrix3Xd& points, std::int64_t hash) {
  shape_t shape = {};
  shape.utime = static_cast<std::int64_t>(time * 1e6 + 0.5);
  shape.mesh_hash = hash;
  put_positions(shape, points);
  return shape;
}

/// The mesh in two chunks of nodes, elements in the first.
inline std::vector<shape_mesh_t> mesh_chunks(const Eigen::Matrix3Xd& rest, int kind,
                                             std::int64_t hash) {
  std::vector<shape_mesh_t> chunks(2);
  const int half = static_cast<int>(rest.cols()) / 2;
  for (int c = 0; c < 2; ++c) {
    shape_mesh_t& chunk = chunks[c];
    chunk = {};
    chunk.mesh_hash = hash;
    chunk.element_kind = kind;
    chunk.chunk = static_cast<std::int16_t>(c);
    chunk.chunks = 2;
    chunk.node_count = static_cast<int>(rest.cols());
    chunk.first_node = c * half;
    const int end = c == 0 ? half : chunk.node_count;
    for (int i = chunk.first_node; i < end; ++i)
      for (int axis = 0; axis < 3; ++axis)
        chunk.rest_xyz.push_back(static_cast<float>(rest(axis, i)));
    chunk.rest_xyz_count = static_cast<int>(chunk.rest_xyz.size());
    chunk.element_size = chunk.node_count;
  }
  for (int i = 0; i < rest.cols(); ++i) chunks[0].elements.push_back(i);
  chunks[0].element_index_count = static_cast<int>(rest.cols());
  return chunks;
}

/// `seconds` of a plant that moves by `truth` (100 Hz) and of an estimate that reports `estimate`
/// for its own nodes (at other times than the truth).
inline log::RunLog synthetic_run(const Deformation& truth, const Deformation& estimate,
                                 double seconds) {
  log::RunLog run;
  run.truth_chunks = mesh_chunks(plant_rest(), shape_mesh_t::QUADRATIC_HEXAHEDRA, 11);
  run.shape_chunks = mesh_chunks(estimate_rest(), shape_mesh_t::LINEAR_TETRAHEDRA, 22);
  for (double time = 0; time < seconds; time += 0.01)
    run.truths.push_back(shape_at(time, moved(plant_rest(), truth, time), 11));
  for (double time = 0.003; time < seconds - 0.01; time += 0.01)
    run.shapes.push_back(shape_at(time, moved(estimate_rest(), estimate, time), 22));
  return run;
}

}  // namespace palpate::scores
