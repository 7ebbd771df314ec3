#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <palpate/shape_mesh_t.hpp>
#include <palpate/shape_t.hpp>
#include <string>
#include <vector>

#include "rt/bus/message_bus.hpp"
#include "rt/bus/session.hpp"

// Meshes and shapes are published in numbered chunks that each fit one datagram: the only splitter
// and the only assemblers. A whole mesh or shape is one message of any size, chunk 0 of 1.

namespace palpate::bus {

/// Largest number of values of 4 bytes in a chunk, which with its header stays below 60 kB.
inline constexpr int kChunkValues = 14'000;

/// Splits a mesh of any size, given as one message, into chunks that each fit one datagram: nodes
/// first, then elements, triangles and constrained nodes. Sets chunk, chunks, first_node and the
/// counts of the arrays; takes hash, element_kind, node_count and element_size from the mesh.
std::vector<shape_mesh_t> split(const shape_mesh_t& mesh);

/// Publishes a mesh on a channel of type shape_mesh_t, chunk by chunk.
class MeshPublisher {
 public:
  MeshPublisher(MessageBus& bus, std::string channel, Urgency urgency, const shape_mesh_t& mesh);

  int chunks() const noexcept { return static_cast<int>(chunks_.size()); }
  /// Publishes one chunk; the next call publishes the next one. Does not allocate.
  void publish_chunk(HeaderStamper& stamp, std::int64_t utime) noexcept;

 private:
  TypedPublisher<shape_mesh_t> publisher_;
  std::vector<shape_mesh_t> chunks_;
  std::size_t next_ = 0;
};

/// Publishes shapes of one mesh, in as many chunks as its nodes need. Positions are
/// encoded where they are sent from, without a message in between. Does not allocate after
/// construction.
class ShapePublisher {
 public:
  ShapePublisher(MessageBus& bus, std::string channel, Urgency urgency, std::int64_t mesh_hash,
                 int node_count);

  struct Shape {
    const double* xyz;       // 3 coordinates of each node, m
    const float* deviation;  // standard deviation of each node, m; nullptr: not estimated
    std::int32_t status;     // of shape_t
    std::int32_t age_us;
  };
  void publish(const Shape& shape, HeaderStamper& stamp, std::int64_t utime) noexcept;

 private:
  TypedPublisher<shape_t> publisher_;
  shape_t head_{};  // without nodes
};

/// Assembles meshes from their chunks, which may arrive in any order, repeatedly, or not at all,
/// with arbitrary contents.
class MeshAssembler {
 public:
  /// Nodes and chunks that a mesh or a shape may have.
  static constexpr int kMostNodes = 1'000'000, kMostChunks = 1'000;

  /// True if this chunk completed its mesh. A chunk that is inconsistent in itself or with those
  /// before is rejected and counted.
  bool add(const shape_mesh_t& chunk);

  /// The whole mesh in one message: chunk 0 of 1, every node given and finite, every index in
  /// range. nullptr if the mesh is unknown or incomplete. The last few meshes are kept.
  std::shared_ptr<const shape_mesh_t> find(std::int64_t hash) const;

  std::int64_t rejected() const { return rejected_; }

 private:
  struct Entry {
    std::vector<std::shared_ptr<const shape_mesh_t>> chunks;
    int missing = 0;
    std::shared_ptr<const shape_mesh_t> mesh;
    std::int64_t last_use = 0;
  };
  void forget_oldest();

  std::map<std::int64_t, Entry> entries_;
  std::int64_t uses_ = 0;
  std::int64_t rejected_ = 0;
};

/// Joins the chunks of the shapes of one channel, which may arrive in any order, repeatedly, or not
/// at all, with arbitrary contents. Numbers may be non-finite. A shape of one chunk is not copied.
class ShapeAssembler {
 public:
  /// The whole shape that this chunk completes, in one message: chunk 0 of 1, xyz of all nodes, and
  /// the deviation of all nodes or of none. Valid until the next call, and may be moved from;
  /// nullptr if none is complete.
  shape_t* add(shape_t&& chunk);

  std::int64_t rejected() const { return rejected_; }

 private:
  struct Partial {
    shape_t shape;
    std::vector<bool> known;  // by chunk
    int missing = 0;          // chunks
    int nodes = 0;            // received
  };
  std::deque<Partial> partial_;  // of the last times
  shape_t whole_{};
  std::int64_t rejected_ = 0;
};

}  // namespace palpate::bus
