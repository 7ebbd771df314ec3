#include "core/elasticity/element_forces.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>

#include "core/elasticity/element_block.hpp"

namespace palpate::elasticity {
namespace {

using math::kLanes;

template <class Pack, int kNodes>
class BlockForces final : public ElementForces {
 public:
  BlockForces(const mesh::ElementMesh& mesh, const std::vector<Lame>& materials,
              const std::vector<int>& numbering, math::Team& team)
      : team_(team) {
    const int count = mesh.element_count();
    constexpr int kWidth = kLanes<Pack>;
    blocks_.resize((count + kWidth - 1) / kWidth);
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      for (int lane = 0; lane < kWidth; ++lane) {
        const int e = static_cast<int>(b) * kWidth + lane;
        // Lanes without an element of their own repeat the last one, without weight.
        blocks_[b].set(lane, mesh, std::min(e, count - 1), materials, numbering, e < count);
      }
    }
    state_.resize(blocks_.size());
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
      Pack energy{};
      part.forces.setZero();
      for (int b = own.begin; b < own.end; ++b) {
        energy += blocks_[b].add(x.data(), viscosity, state_[b], part.forces.data());
      }
      part.energy = energy;
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

  void reset() noexcept override { std::fill(state_.begin(), state_.end(), BlockState()); }

  void node_rotations(Eigen::Matrix4Xf& rotations) noexcept override {
    const auto of_elements = [&](int member, int size) {
      const math::Share own(block_count(), member, size);
      parts_[member].rotations.setZero();
      for (int b = own.begin; b < own.end; ++b) {
        add_rotations(b, rotations, parts_[member].rotations);
      }
    };
    team_.run(of_elements);
    Eigen::Matrix4Xf& sums = parts_[0].rotations;
    const auto together = [&](int member, int size) {
      add_parts(&Part::rotations, {static_cast<int>(sums.cols()), member, size});
    };
    if (parts_.size() > 1) team_.run(together);
    for (int b = 0; b < block_count() && kNodes == 10; ++b) {
      for (int lane = 0; lane < kLanes<Pack>; ++lane) {
        for (int m = 4; m < kNodes; ++m) {
          const int* edge = mesh::kTetrahedronEdges[m - 4];
          const auto i = sums.col(blocks_[b].node(edge[0], lane));
          const auto j = sums.col(blocks_[b].node(edge[1], lane));
          const float sign = i.dot(j) < 0 ? -1.0F : 1.0F;
          sums.col(blocks_[b].node(m, lane)) = i + sign * j;
        }
      }
    }
    for (int node = 0; node < rotations.cols(); ++node) {
      const float length = sums.col(node).norm();
      if (length > 0) rotations.col(node) = sums.col(node) / length;
    }
  }

  int inverted(const NodalField& x) const noexcept override {
    int count = 0;
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      count += blocks_[b].inverted(x.data(), state_[b]);
    }
    return count;
  }

 private:
  using Block = ElementBlock<Pack, kNodes>;
  using Field = Eigen::Matrix<typename Block::Real, 4, Eigen::Dynamic>;
  using BlockState = typename Block::State;
  /// Sums over one member's elements.
  struct alignas(64) Part {
    Pack energy{};
    Field forces;
    Eigen::Matrix4Xf rotations;  // unit quaternions
  };

  int block_count() const { return static_cast<int>(blocks_.size()); }

  /// A share of the nodes of a field of the first part, to which those of the others are added.
  template <class PartField>
  auto add_parts(PartField Part::*field, const math::Share& nodes) noexcept {
    auto sums = (parts_[0].*field).middleCols(nodes.begin, nodes.size());
    for (std::size_t m = 1; m < parts_.size(); ++m) {
      sums += (parts_[m].*field).middleCols(nodes.begin, nodes.size());
    }
    return sums;
  }

  /// To the corners of a block's elements, with the sign that fits `recent`.
  void add_rotations(int b, const Eigen::Matrix4Xf& recent, Eigen::Matrix4Xf& sums) const {
    for (int lane = 0; lane < kLanes<Pack> && blocks_[b].has_element(lane); ++lane) {
      Eigen::Vector4f q = Eigen::Vector4f::Zero();
      for (const auto& point : state_[b]) {
        Eigen::Vector4f p;
        for (int k = 0; k < 4; ++k) p(k) = static_cast<float>(point.rotation[k][lane]);
        q += p.dot(q) < 0 ? Eigen::Vector4f(-p) : p;
      }
      for (int a = 0; a < 4; ++a) {
        const int node = blocks_[b].node(a, lane);
        if (q.dot(recent.col(node)) < 0) {
          sums.col(node) -= q;
        } else {
          sums.col(node) += q;
        }
      }
    }
  }

  math::Team& team_;
  std::vector<Block> blocks_;
  std::vector<BlockState> state_;
  std::vector<Part> parts_;
};

}  // namespace

std::unique_ptr<ElementForces> make_element_forces(const mesh::ElementMesh& mesh,
                                                   const std::vector<Lame>& materials,
                                                   const std::vector<int>& numbering,
                                                   Precision precision, math::Team& team) {
  using math::Pack4d;
  using math::Pack8f;
  if (mesh.order == mesh::ElementOrder::kLinear) {
    if (precision == Precision::kDouble) {
      return std::make_unique<BlockForces<Pack4d, 4>>(mesh, materials, numbering, team);
    }
    return std::make_unique<BlockForces<Pack8f, 4>>(mesh, materials, numbering, team);
  }
  if (precision == Precision::kDouble) {
    return std::make_unique<BlockForces<Pack4d, 10>>(mesh, materials, numbering, team);
  }
  return std::make_unique<BlockForces<Pack8f, 10>>(mesh, materials, numbering, team);
}

std::vector<int> mesh_numbering(const mesh::ElementMesh& mesh) {
  std::vector<int> numbering(mesh.node_count());
  std::iota(numbering.begin(), numbering.end(), 0);
  return numbering;
}

}  // namespace palpate::elasticity
