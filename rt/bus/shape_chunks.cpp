#include "rt/bus/shape_chunks.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

namespace palpate::bus {
namespace {

constexpr int kNodesPerChunk = kChunkValues / 4;  // 3 coordinates and a standard deviation

/// Distributes `count` values over as many chunks as needed, in groups that stay together; `add`
/// receives chunk, first and last.
template <class Add>
void deal(std::size_t count, std::size_t group, std::vector<shape_mesh_t>& chunks,
          std::vector<std::size_t>& room, Add add) {
  std::size_t done = 0, chunk = 0;
  while (done < count) {
    if (chunk == chunks.size()) {
      chunks.emplace_back();
      room.push_back(kChunkValues);
    }
    const std::size_t n = std::min(count - done, room[chunk] / group * group);
    if (n > 0) add(chunks[chunk], done, done + n);
    room[chunk] -= n;
    done += n;
    if (done < count) ++chunk;
  }
}

template <class T>
std::int32_t size_of(const std::vector<T>& list) {
  return static_cast<std::int32_t>(list.size());
}

std::uint8_t* put(std::uint8_t* to, std::uint32_t number) noexcept {
  const std::uint32_t big_endian = __builtin_bswap32(number);
  std::memcpy(to, &big_endian, sizeof(big_endian));
  return to + sizeof(big_endian);
}

template <class Number>
std::uint8_t* put(std::uint8_t* to, const Number* numbers, int count) noexcept {
  to = put(to, static_cast<std::uint32_t>(count));
  for (int i = 0; i < count; ++i) {
    const auto value = static_cast<float>(numbers[i]);
    std::uint32_t bits = 0;
    std::memcpy(&bits, &value, sizeof(bits));
    to = put(to, bits);
  }
  return to;
}

constexpr std::size_t kMostMeshes = 8;
constexpr std::size_t kMostPartial = 4;  // incomplete shapes

/// Whether chunk number and range of nodes are possible; `values`: number of its coordinates.
template <class Chunk>
bool is_in_range(const Chunk& chunk, std::size_t values) {
  return chunk.chunks >= 1 && chunk.chunks <= MeshAssembler::kMostChunks && chunk.chunk >= 0 &&
         chunk.chunk < chunk.chunks && chunk.node_count >= 1 &&
         chunk.node_count <= MeshAssembler::kMostNodes && chunk.first_node >= 0 &&
         values % 3 == 0 &&
         std::int64_t{chunk.first_node} + static_cast<std::int64_t>(values / 3) <= chunk.node_count;
}

bool is_sound(const shape_mesh_t& chunk) {
  return is_in_range(chunk, chunk.rest_xyz.size()) && chunk.element_size >= 1 &&
         chunk.element_size <= 64 && chunk.triangles.size() % 3 == 0 &&
         chunk.elements.size() % static_cast<std::size_t>(chunk.element_size) == 0 &&
         std::all_of(chunk.rest_xyz.begin(), chunk.rest_xyz.end(),
                     [](float x) { return std::isfinite(x) && std::fabs(x) < 1e4F; });
}

bool is_sound(const shape_t& chunk) {
  return is_in_range(chunk, chunk.xyz.size()) && !chunk.xyz.empty() &&
         (chunk.deviation.empty() || 3 * chunk.deviation.size() == chunk.xyz.size());
}

bool within(const std::vector<std::int32_t>& indices, int count) {
  return std::all_of(indices.begin(), indices.end(),
                     [count](std::int32_t i) { return i >= 0 && i < count; });
}

template <class T>
void append(std::vector<T>& whole, const std::vector<T>& part) {
  whole.insert(whole.end(), part.begin(), part.end());
}

/// nullptr if nodes are missing or indices are out of range.
std::shared_ptr<const shape_mesh_t> assemble(
    const std::vector<std::shared_ptr<const shape_mesh_t>>& chunks) {
  auto mesh = std::make_shared<shape_mesh_t>(*chunks.front());
  const auto count = static_cast<std::size_t>(mesh->node_count);
  std::size_t given = 0;
  for (const auto& chunk : chunks) given += chunk->rest_xyz.size() / 3;
  if (given < count) return nullptr;  // before anything of the announced size is allocated
  mesh->chunk = 0;
  mesh->chunks = 1;
  mesh->first_node = 0;
  mesh->rest_xyz.assign(3 * count, 0);
  mesh->elements.clear();
  mesh->triangles.clear();
  mesh->constrained.clear();
  std::vector<bool> known(count, false);
  for (const auto& chunk : chunks) {
    std::copy(chunk->rest_xyz.begin(), chunk->rest_xyz.end(),
              mesh->rest_xyz.begin() + std::ptrdiff_t{3} * chunk->first_node);
    std::fill_n(known.begin() + chunk->first_node, chunk->rest_xyz.size() / 3, true);
    append(mesh->elements, chunk->elements);
    append(mesh->triangles, chunk->triangles);
    append(mesh->constrained, chunk->constrained);
  }
  mesh->rest_xyz_count = size_of(mesh->rest_xyz);
  mesh->element_index_count = size_of(mesh->elements);
  mesh->triangle_index_count = size_of(mesh->triangles);
  mesh->constrained_count = size_of(mesh->constrained);
  const bool is_whole = std::all_of(known.begin(), known.end(), [](bool k) { return k; }) &&
                        within(mesh->elements, mesh->node_count) &&
                        within(mesh->triangles, mesh->node_count) &&
                        within(mesh->constrained, mesh->node_count);
  return is_whole ? mesh : nullptr;
}

}  // namespace

std::vector<shape_mesh_t> split(const shape_mesh_t& mesh) {
  std::vector<shape_mesh_t> chunks;
  std::vector<std::size_t> room;
  const auto part = [&](auto member, std::size_t group) {
    const auto& all = mesh.*member;
    deal(all.size(), group, chunks, room,
         [&](shape_mesh_t& chunk, std::size_t first, std::size_t last) {
           (chunk.*member)
               .assign(all.begin() + static_cast<std::ptrdiff_t>(first),
                       all.begin() + static_cast<std::ptrdiff_t>(last));
         });
  };
  part(&shape_mesh_t::rest_xyz, 3);
  part(&shape_mesh_t::elements, static_cast<std::size_t>(mesh.element_size));
  part(&shape_mesh_t::triangles, 3);
  part(&shape_mesh_t::constrained, 1);
  std::int32_t nodes = 0;
  for (std::size_t i = 0; i < chunks.size(); ++i) {
    shape_mesh_t& chunk = chunks[i];
    chunk.mesh_hash = mesh.mesh_hash;
    chunk.element_kind = mesh.element_kind;
    chunk.chunk = static_cast<std::int16_t>(i);
    chunk.chunks = static_cast<std::int16_t>(chunks.size());
    chunk.node_count = mesh.node_count;
    chunk.first_node = nodes;
    nodes += size_of(chunk.rest_xyz) / 3;
    chunk.element_size = mesh.element_size;
    chunk.rest_xyz_count = size_of(chunk.rest_xyz);
    chunk.element_index_count = size_of(chunk.elements);
    chunk.triangle_index_count = size_of(chunk.triangles);
    chunk.constrained_count = size_of(chunk.constrained);
  }
  return chunks;
}

MeshPublisher::MeshPublisher(MessageBus& bus, std::string channel, Urgency urgency,
                             const shape_mesh_t& mesh)
    : publisher_(bus, std::move(channel), urgency), chunks_(split(mesh)) {
  for (const shape_mesh_t& chunk : chunks_) publisher_.reserve(chunk.getEncodedSize());
}

void MeshPublisher::publish_chunk(HeaderStamper& stamp, std::int64_t utime) noexcept {
  if (chunks_.empty()) return;
  shape_mesh_t& chunk = chunks_[next_];
  next_ = (next_ + 1) % chunks_.size();
  stamp.put(chunk, utime);
  publisher_.publish(chunk);
}

ShapePublisher::ShapePublisher(MessageBus& bus, std::string channel, Urgency urgency,
                               std::int64_t mesh_hash, int node_count)
    : publisher_(bus, std::move(channel), urgency) {
  head_.mesh_hash = mesh_hash;
  head_.node_count = node_count;
  head_.chunks = static_cast<std::int16_t>((node_count + kNodesPerChunk - 1) / kNodesPerChunk);
  publisher_.reserve(head_.getEncodedSize() + 16 * std::min(node_count, kNodesPerChunk));
}

void ShapePublisher::publish(const Shape& shape, HeaderStamper& stamp,
                             std::int64_t utime) noexcept {
  head_.status = shape.status;
  head_.age_us = shape.age_us;
  for (int chunk = 0; chunk < head_.chunks; ++chunk) {
    stamp.put(head_, utime);
    head_.chunk = static_cast<std::int16_t>(chunk);
    head_.first_node = chunk * kNodesPerChunk;
    const int nodes = std::min(kNodesPerChunk, head_.node_count - head_.first_node);
    const int deviations = shape.deviation == nullptr ? 0 : nodes;
    const int head_size = head_.getEncodedSize();
    publisher_.publish_encoded(head_size + 4 * (3 * nodes + deviations), [&](std::uint8_t* to) {
      // the head ends with the counts of its two empty arrays
      head_.encode(to, 0, head_size);
      to = put(to + head_size - 8, shape.xyz + std::ptrdiff_t{3} * head_.first_node, 3 * nodes);
      put(to, deviations == 0 ? nullptr : shape.deviation + head_.first_node, deviations);
    });
  }
}

bool MeshAssembler::add(const shape_mesh_t& chunk) {
  if (!is_sound(chunk)) return ++rejected_, false;
  Entry& entry = entries_[chunk.mesh_hash];
  entry.last_use = ++uses_;
  if (entry.mesh) return false;
  if (entry.chunks.empty()) {
    entry.chunks.resize(static_cast<std::size_t>(chunk.chunks));
    entry.missing = chunk.chunks;
    forget_oldest();
  }
  const auto other = std::find_if(entry.chunks.begin(), entry.chunks.end(),
                                  [](const auto& c) { return c != nullptr; });
  if (chunk.chunks != static_cast<int>(entry.chunks.size()) ||
      (other != entry.chunks.end() &&
       ((*other)->node_count != chunk.node_count || (*other)->element_size != chunk.element_size ||
        (*other)->element_kind != chunk.element_kind)))
    return ++rejected_, false;
  auto& place = entry.chunks[static_cast<std::size_t>(chunk.chunk)];
  if (place) return false;
  place = std::make_shared<const shape_mesh_t>(chunk);
  if (--entry.missing > 0) return false;
  entry.mesh = assemble(entry.chunks);
  if (!entry.mesh) {
    entries_.erase(chunk.mesh_hash);  // to be collected again
    return ++rejected_, false;
  }
  entry.chunks.clear();
  return true;
}

std::shared_ptr<const shape_mesh_t> MeshAssembler::find(std::int64_t hash) const {
  const auto entry = entries_.find(hash);
  return entry == entries_.end() ? nullptr : entry->second.mesh;
}

void MeshAssembler::forget_oldest() {
  while (entries_.size() > kMostMeshes) {
    entries_.erase(std::min_element(entries_.begin(), entries_.end(), [](auto& a, auto& b) {
      return a.second.last_use < b.second.last_use;
    }));
  }
}

shape_t* ShapeAssembler::add(shape_t&& chunk) {
  if (!is_sound(chunk)) return ++rejected_, nullptr;
  if (chunk.chunks == 1) {
    if (size_of(chunk.xyz) != 3 * chunk.node_count) return ++rejected_, nullptr;
    whole_ = std::move(chunk);
    return &whole_;
  }
  auto found = std::find_if(partial_.begin(), partial_.end(), [&chunk](const Partial& one) {
    return one.shape.session == chunk.session && one.shape.utime == chunk.utime;
  });
  if (found == partial_.end()) {
    if (partial_.size() >= kMostPartial) partial_.pop_front();
    found = partial_.insert(partial_.end(), Partial{chunk, {}, chunk.chunks, 0});
    found->known.assign(static_cast<std::size_t>(chunk.chunks), false);
    found->shape.xyz.clear();
    found->shape.deviation.clear();
  }
  shape_t& shape = found->shape;
  if (chunk.mesh_hash != shape.mesh_hash || chunk.node_count != shape.node_count ||
      chunk.chunks != shape.chunks || (chunk.deviation_count == 0) != (shape.deviation_count == 0))
    return ++rejected_, nullptr;
  if (found->known[static_cast<std::size_t>(chunk.chunk)]) return nullptr;
  found->known[static_cast<std::size_t>(chunk.chunk)] = true;
  // grows with what arrives, not with what a chunk announces
  const auto put = [](std::vector<float>& all, const std::vector<float>& part, std::size_t at) {
    if (all.size() < at + part.size()) all.resize(at + part.size());
    std::copy(part.begin(), part.end(), all.begin() + static_cast<std::ptrdiff_t>(at));
  };
  const auto first = static_cast<std::size_t>(chunk.first_node);
  put(shape.xyz, chunk.xyz, 3 * first);
  put(shape.deviation, chunk.deviation, chunk.deviation.empty() ? 0 : first);
  found->nodes += size_of(chunk.xyz) / 3;
  if (--found->missing > 0) return nullptr;
  const bool is_whole =
      found->nodes == shape.node_count && size_of(shape.xyz) == 3 * shape.node_count;
  whole_ = std::move(shape);
  partial_.erase(partial_.begin(), found + 1);  // older ones stay incomplete
  if (!is_whole) return ++rejected_, nullptr;
  whole_.chunk = 0;
  whole_.chunks = 1;
  whole_.first_node = 0;
  whole_.xyz_count = size_of(whole_.xyz);
  whole_.deviation_count = size_of(whole_.deviation);
  return &whole_;
}

}  // namespace palpate::bus
