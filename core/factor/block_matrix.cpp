#include "core/factor/block_matrix.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "core/math/pack.hpp"

namespace palpate::factor {

namespace {

/// Graph of the unknowns that share an element.
Graph mesh_graph(const Eigen::MatrixXi& elements, const std::vector<int>& unknown, int size) {
  std::vector<std::vector<int>> neighbours(size);
  for (int e = 0; e < elements.cols(); ++e) {
    for (int a : elements.col(e)) {
      for (int b : elements.col(e)) {
        if (a != b && unknown[a] >= 0 && unknown[b] >= 0) {
          neighbours[unknown[a]].push_back(unknown[b]);
        }
      }
    }
  }
  Graph graph;
  for (std::vector<int>& list : neighbours) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
    graph.neighbours.insert(graph.neighbours.end(), list.begin(), list.end());
    graph.start.push_back(static_cast<int>(graph.neighbours.size()));
  }
  return graph;
}

}  // namespace

BlockPattern::BlockPattern(const Eigen::MatrixXi& elements, int node_count,
                           const std::vector<int>& fixed,
                           const std::vector<std::vector<int>>& border, Orders more)
    : nodes_per_element_(static_cast<int>(elements.rows())), unknown_(node_count, 0) {
  if (border.size() > 2) throw std::invalid_argument("at most two grasp patches");
  for (int node : fixed) unknown_.at(node) = -1;
  // natural order first: the interior, then the groups
  for (const std::vector<int>& group : border) {
    for (int node : group) {
      if (node < 0 || node >= node_count || unknown_[node] != 0) {
        throw std::invalid_argument("grasped node " + std::to_string(node) +
                                    " is out of range, fixed or grasped twice");
      }
      unknown_[node] = 1;
    }
  }
  std::vector<int> natural;
  for (int node = 0; node < node_count; ++node) {
    if (unknown_[node] == 0) natural.push_back(node);
  }
  for (int g = 0; g < 2; ++g) {
    border_begin_[g] = static_cast<int>(natural.size());
    if (g < static_cast<int>(border.size())) {
      natural.insert(natural.end(), border[g].begin(), border[g].end());
    }
  }
  const int n = border_begin_[2] = static_cast<int>(natural.size());
  for (int i = 0; i < n; ++i) unknown_[natural[i]] = i;

  const Graph graph = mesh_graph(elements, unknown_, n);
  const std::vector<int> order = elimination_order(graph, n - interior_size(), more);
  node_.resize(n);
  for (int k = 0; k < n; ++k) node_[k] = natural[order[k]];
  for (int k = 0; k < n; ++k) unknown_[node_[k]] = k;

  column_start_.assign(n + 1, 0);
  for (int k = 0; k < n; ++k) {
    const std::size_t begin = row_.size();
    row_.push_back(k);
    for (int s = graph.start[order[k]]; s < graph.start[order[k] + 1]; ++s) {
      const int i = unknown_[natural[graph.neighbours[s]]];
      if (i > k) row_.push_back(i);
    }
    std::sort(row_.begin() + static_cast<std::ptrdiff_t>(begin), row_.end());
    column_start_[k + 1] = static_cast<int>(row_.size());
  }

  slots_.assign(elements.size() * nodes_per_element_, -1);
  for (int e = 0; e < elements.cols(); ++e) {
    for (int a = 0; a < nodes_per_element_; ++a) {
      for (int b = 0; b < nodes_per_element_; ++b) {
        const int i = unknown_[elements(a, e)], k = unknown_[elements(b, e)];
        if (i < k || k < 0) continue;
        const auto found = std::lower_bound(row_.begin() + column_start_[k],
                                            row_.begin() + column_start_[k + 1], i);
        slots_[(e * nodes_per_element_ + a) * nodes_per_element_ + b] =
            static_cast<int>(found - row_.begin());
      }
    }
  }
}

BlockMatrix::BlockMatrix(const BlockPattern& pattern)
    : pattern_(&pattern), blocks_(pattern.row().size(), Eigen::Matrix3d::Zero()) {}

void BlockMatrix::set_zero() { std::fill(blocks_.begin(), blocks_.end(), Eigen::Matrix3d::Zero()); }

void BlockMatrix::add(double factor, const BlockMatrix& other) noexcept {
  for (std::size_t k = 0; k < blocks_.size(); ++k) blocks_[k] += factor * other.blocks_[k];
}

void BlockMatrix::add_scalar(double factor, const Eigen::VectorXd& blocks) noexcept {
  for (int k = 0; k < blocks.size(); ++k) blocks_[k].diagonal().array() += factor * blocks(k);
}

void BlockMatrix::add(int element, const Eigen::MatrixXd& K) {
  const int n = static_cast<int>(K.rows()) / 3;
  for (int a = 0; a < n; ++a) {
    for (int b = 0; b < n; ++b) {
      const int slot = pattern_->slot(element, a, b);
      if (slot >= 0) blocks_[slot] += K.block<3, 3>(3 * a, 3 * b);
    }
  }
}

void BlockMatrix::add_scalar(int element, double factor, const Eigen::MatrixXd& M) {
  const int n = static_cast<int>(M.rows());
  for (int a = 0; a < n; ++a) {
    for (int b = 0; b < n; ++b) {
      const int slot = pattern_->slot(element, a, b);
      if (slot >= 0) blocks_[slot].diagonal().array() += factor * M(a, b);
    }
  }
}

void BlockMatrix::multiply(const Eigen::Matrix3Xd& u, Eigen::Matrix3Xd& y) const {
  y.setZero();
  const std::vector<int>& start = pattern_->column_start();
  for (int k = 0; k < pattern_->size(); ++k) {
    const int node_k = pattern_->node(k);
    for (int s = start[k]; s < start[k + 1]; ++s) {
      const int node_i = pattern_->node(pattern_->row()[s]);
      y.col(node_i).noalias() += blocks_[s] * u.col(node_k);
      if (node_i != node_k) y.col(node_k).noalias() += blocks_[s].transpose() * u.col(node_i);
    }
  }
}

void BlockMatrix::multiply(const NodalColumns& u, NodalColumns& y) const noexcept {
  using math::Pack4d;
  const std::vector<int>& start = pattern_->column_start();
  const std::ptrdiff_t width = u.cols();
  y.setZero();
  for (int first = 0; first < width; first += math::kLanes<Pack4d>) {
    const auto offset = [&](int unknown) { return 3 * pattern_->node(unknown) * width + first; };
    for (int k = 0; k < pattern_->size(); ++k) {
      const std::ptrdiff_t at = offset(k);
      Pack4d own[3], sum[3];  // u and y of the column's node
      for (int c = 0; c < 3; ++c) {
        own[c] = math::load(u.data() + at + c * width);
        sum[c] = math::load(y.data() + at + c * width);
      }
      const double* block = blocks_[start[k]].data();
      for (int c = 0; c < 3; ++c) {
        for (int r = 0; r < 3; ++r) sum[r] += block[3 * c + r] * own[c];
      }
      for (int s = start[k] + 1; s < start[k + 1]; ++s) {
        block = blocks_[s].data();
        const std::ptrdiff_t row = offset(pattern_->row()[s]);
        const double* other = u.data() + row;
        double* target = y.data() + row;
        for (int r = 0; r < 3; ++r, other += width, target += width) {
          const Pack4d pack = math::load(other);
          Pack4d to = math::load(target);
          for (int c = 0; c < 3; ++c) {
            to += block[3 * c + r] * own[c];
            sum[c] += block[3 * c + r] * pack;
          }
          math::store(to, target);
        }
      }
      for (int c = 0; c < 3; ++c) math::store(sum[c], y.data() + at + c * width);
    }
  }
}

}  // namespace palpate::factor
