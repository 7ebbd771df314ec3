#include "core/elasticity/element_forces.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <list>
#include <numeric>
#include <stdexcept>
#include <string>

#include "core/elasticity/element_block.hpp"
#include "core/elasticity/principal_kernel.hpp"

namespace palpate::elasticity {
namespace {

/// Order of the elements in blocks of `width`: by their lowest column in nodal fields, for
/// locality, but if possible without two elements of a block sharing a node, because the additions
/// to it would wait for each other.
std::vector<int> block_order(const mesh::ElementMesh& mesh, const std::vector<int>& numbering,
                             int width) {
  constexpr int kLookAhead = 256;
  const int count = mesh.element_count();
  std::vector<int> lowest(count, static_cast<int>(numbering.size()));
  for (int e = 0; e < count; ++e) {
    for (int node : mesh.elements.col(e)) lowest[e] = std::min(lowest[e], numbering[node]);
  }
  std::vector<int> sorted(count);
  std::iota(sorted.begin(), sorted.end(), 0);
  std::stable_sort(sorted.begin(), sorted.end(),
                   [&](int a, int b) { return lowest[a] < lowest[b]; });
  std::list<int> waiting(sorted.begin(), sorted.end());
  std::vector<int> order, last_block(numbering.size(), -1);
  while (!waiting.empty()) {
    const int block = static_cast<int>(order.size()) / width;
    const auto is_apart = [&](int e) {
      const auto nodes = mesh.elements.col(e);
      return std::none_of(nodes.begin(), nodes.end(),
                          [&](int node) { return last_block[node] == block; });
    };
    auto next = waiting.begin();
    for (int k = 0; k < kLookAhead && next != waiting.end() && !is_apart(*next); ++k) ++next;
    if (next == waiting.end() || !is_apart(*next)) next = waiting.begin();
    for (int node : mesh.elements.col(*next)) last_block[node] = block;
    order.push_back(*next);
    waiting.erase(next);
  }
  return order;
}

/// `Law`: as LinearStress.
template <class Pack, int kNodes, class Law>
class BlockForces final : public ElementForces {
 public:
  BlockForces(const Law& law, const mesh::ElementMesh& mesh, const std::vector<Lame>& materials,
              const std::vector<int>& numbering, math::Team& team)
      : law_(law), team_(team) {
    const int count = mesh.element_count();
    constexpr int kWidth = Block::kElements;
    blocks_.resize((count + kWidth - 1) / kWidth);
    const std::vector<int> order = block_order(mesh, numbering, kWidth);
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      for (int lane = 0; lane < kWidth; ++lane) {
        const int k = static_cast<int>(b) * kWidth + lane;
        // lanes without an element repeat the last one with weight zero
        blocks_[b].set(lane, mesh, order[std::min(k, count - 1)], materials, numbering, k < count);
      }
    }
    state_.resize(blocks_.size());
    axes_.resize(blocks_.size());
    std::vector<bool> is_known(numbering.size());
    for (int e = 0; e < count; ++e) {
      for (int m = 4; m < kNodes; ++m) {
        const auto nodes = mesh.elements.col(e);
        const int* edge = mesh::kTetrahedronEdges[m - 4];
        if (is_known[nodes(m)]) continue;
        is_known[nodes(m)] = true;
        midsides_.push_back(
            {numbering[nodes(m)], {numbering[nodes(edge[0])], numbering[nodes(edge[1])]}});
      }
    }
    parts_.resize(static_cast<std::size_t>(team.size()));
    for (Part& part : parts_) {
      part.forces.setZero(4, static_cast<int>(numbering.size()));
      part.rotations.setZero(4, static_cast<int>(numbering.size()));
    }
  }

  double add(const NodalField& x, double viscosity, NodalField& forces) noexcept override {
    const auto of_elements = [&](int member, int size) {
      Part& part = parts_[member];
      const math::Share own(block_count(), member, size);
      part.forces.setZero();
      part.energy = add_blocks(own, x, viscosity, part.forces);
    };
    team_.run(of_elements);
    const auto of_nodes = [&](int member, int size) {
      const math::Share own(static_cast<int>(forces.cols()), member, size);
      auto sums = add_parts(&Part::forces, own);
      forces.middleCols(own.begin, own.size()) += sums.template cast<double>();
    };
    team_.run(of_nodes);
    Pack energy = parts_[0].energy;
    for (std::size_t m = 1; m < parts_.size(); ++m) energy += parts_[m].energy;
    return math::sum(energy);
  }

  void begin_step() noexcept override {
    const auto keep = [this](int member, int size) {
      const math::Share own(block_count(), member, size);
      for (int b = own.begin; b < own.end; ++b) {
        for (auto& point : state_[b]) point.previous_strain = point.strain;
      }
    };
    team_.run(keep);
  }

  void reset() noexcept override {
    std::fill(state_.begin(), state_.end(), BlockState());
    std::fill(axes_.begin(), axes_.end(), BlockAxes());
  }

  void node_rotations(Eigen::Matrix4Xf& rotations) noexcept override {
    const auto of_elements = [&](int member, int size) {
      const math::Share own(block_count(), member, size);
      Eigen::Matrix4Xf& sums = parts_[member].rotations;
      sums.setZero();
      for (int b = own.begin; b < own.end; ++b) {
        blocks_[b].add_rotations(state_[b], rotations.data(), sums.data());
      }
    };
    team_.run(of_elements);
    Eigen::Matrix4Xf& sums = parts_[0].rotations;
    const auto together = [&](int member, int size) {
      add_parts(&Part::rotations, {static_cast<int>(sums.cols()), member, size});
    };
    if (parts_.size() > 1) team_.run(together);
    for (const Midside& midside : midsides_) {
      const auto i = sums.col(midside.ends[0]), j = sums.col(midside.ends[1]);
      const float sign = i.dot(j) < 0 ? -1.0F : 1.0F;
      sums.col(midside.node) = i + sign * j;
    }
    for (int node = 0; node < rotations.cols(); ++node) {
      const float square = sums.col(node).squaredNorm();
      if (square > 0) rotations.col(node) = (1 / std::sqrt(square)) * sums.col(node);
    }
  }

  ElementDoubts doubts(const NodalField& x, double limit) const noexcept override {
    ElementDoubts doubts;
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      blocks_[b].add_doubts(x.data(), state_[b], limit, doubts);
    }
    return doubts;
  }

 private:
  using Block = ElementBlock<Pack, kNodes>;
  using Field = Eigen::Matrix<typename Block::Real, 4, Eigen::Dynamic>;
  using BlockState = typename Block::State;
  using BlockAxes = typename Block::template Axes<Law>;
  struct Midside {
    int node;
    std::array<int, 2> ends;
  };
  /// Sums over one member's elements.
  struct alignas(64) Part {
    Pack energy{};
    Field forces;
    Eigen::Matrix4Xf rotations;  // unit quaternions
  };

  int block_count() const { return static_cast<int>(blocks_.size()); }

  /// Adds the fields of the other parts to the first part's, for a share of the nodes.
  template <class PartField>
  auto add_parts(PartField Part::*field, const math::Share& nodes) noexcept {
    auto sums = (parts_[0].*field).middleCols(nodes.begin, nodes.size());
    for (std::size_t m = 1; m < parts_.size(); ++m) {
      sums += (parts_[m].*field).middleCols(nodes.begin, nodes.size());
    }
    return sums;
  }

  /// Adds the forces of a share of the blocks to `sums`.
  Pack add_blocks(const math::Share& blocks, const NodalField& x, double viscosity,
                  Field& sums) noexcept {
    Pack energy{};
    for (int b = blocks.begin; b < blocks.end; ++b) {
      energy += blocks_[b].add(law_, x.data(), viscosity, state_[b], axes_[b], sums.data());
    }
    return energy;
  }

  Law law_;
  math::Team& team_;
  std::vector<Block> blocks_;
  std::vector<BlockState> state_;
  std::vector<BlockAxes> axes_;
  std::vector<Midside> midsides_;
  std::vector<Part> parts_;
};

template <class Law>
std::unique_ptr<ElementForces> make_block_forces(const Law& law, const mesh::ElementMesh& mesh,
                                                 const std::vector<Lame>& lame,
                                                 const std::vector<int>& numbering,
                                                 Precision precision, math::Team& team) {
  using math::Pack4d;
  using math::Pack8f;
  if (mesh.order == mesh::ElementOrder::kLinear) {
    if (precision == Precision::kDouble) {
      return std::make_unique<BlockForces<Pack4d, 4, Law>>(law, mesh, lame, numbering, team);
    }
    return std::make_unique<BlockForces<Pack8f, 4, Law>>(law, mesh, lame, numbering, team);
  }
  if (precision == Precision::kDouble) {
    return std::make_unique<BlockForces<Pack4d, 10, Law>>(law, mesh, lame, numbering, team);
  }
  return std::make_unique<BlockForces<Pack8f, 10, Law>>(law, mesh, lame, numbering, team);
}

}  // namespace

std::unique_ptr<ElementForces> make_element_forces(const mesh::ElementMesh& mesh,
                                                   const ElementMaterials& materials,
                                                   const std::vector<int>& numbering,
                                                   Precision precision, math::Team& team) {
  if (!materials.law)
    return make_block_forces(LinearStress(), mesh, materials.lame, numbering, precision, team);
  return make_block_forces(HyperelasticStress{*materials.law}, mesh, materials.lame, numbering,
                           precision, team);
}

std::vector<int> mesh_numbering(const mesh::ElementMesh& mesh) {
  std::vector<int> numbering(mesh.node_count());
  std::iota(numbering.begin(), numbering.end(), 0);
  return numbering;
}

}  // namespace palpate::elasticity
