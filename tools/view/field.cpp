#include "tools/view/field.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>

namespace palpate::view {
namespace {

constexpr const char* kNames[] = {"displacement", "strain", "stress", "uncertainty"};

Eigen::Vector3f at(const std::vector<float>& xyz, std::int32_t node) {
  return Eigen::Vector3f::Map(xyz.data() + std::ptrdiff_t{3} * node);
}

}  // namespace

const char* name(Field field) { return kNames[static_cast<int>(field)]; }

bool field_from(const std::string& name, Field& field) {
  for (int i = 0; i < 4; ++i) {
    if (name != kNames[i]) continue;
    field = static_cast<Field>(i);
    return true;
  }
  return false;
}

/// Stress for E = 1 Pa, to which it is proportional, at a given Poisson's ratio.
struct FieldEvaluator::Mechanics {
  double poisson_ratio;
  elasticity::Body body;
  std::unique_ptr<elasticity::StressEvaluator> evaluator;
  elasticity::ElementStress result;
  Eigen::Matrix3Xd x;
};

FieldEvaluator::FieldEvaluator(std::shared_ptr<const shape_mesh_t> mesh) : mesh_(std::move(mesh)) {
  node_volume_.assign(static_cast<std::size_t>(mesh_->node_count), 0.0F);
  read_elements();
}

FieldEvaluator::~FieldEvaluator() = default;

void FieldEvaluator::read_elements() {
  // Tetrahedra along each of the six paths from corner 000 to corner 111 of a cube.
  constexpr int kWays[6][2] = {{1, 3}, {1, 5}, {2, 3}, {2, 6}, {4, 5}, {4, 6}};
  // Of ten nodes: the four corners, and the octahedron between the middles of the edges.
  constexpr std::size_t kParts[8][4] = {{0, 4, 6, 7}, {1, 5, 4, 8}, {2, 6, 5, 9}, {3, 7, 8, 9},
                                        {4, 9, 5, 6}, {4, 9, 6, 7}, {4, 9, 7, 8}, {4, 9, 8, 5}};
  const std::vector<std::int32_t>& e = mesh_->elements;
  const auto size = static_cast<std::size_t>(mesh_->element_size);
  for (std::size_t first = 0; first < e.size(); first += size) {
    if (size == 4) add_tetrahedron({e[first], e[first + 1], e[first + 2], e[first + 3]});
    for (const auto& part : kParts)
      if (size == 10)
        add_tetrahedron(
            {e[first + part[0]], e[first + part[1]], e[first + part[2]], e[first + part[3]]});
    if (size != 27) continue;
    for (int cell = 0; cell < 8; ++cell) {
      const auto corner = [&](int c) {
        const int i = (cell & 1) + (c & 1), j = (cell >> 1 & 1) + (c >> 1 & 1),
                  k = (cell >> 2) + (c >> 2);
        return e[first + static_cast<std::size_t>(i + 3 * j + 9 * k)];
      };
      for (const auto& way : kWays)
        add_tetrahedron({corner(0), corner(way[0]), corner(way[1]), corner(7)});
    }
  }
}

void FieldEvaluator::add_tetrahedron(std::array<std::int32_t, 4> node) {
  const auto edges = [&] {
    Eigen::Matrix3f E;
    for (int c = 0; c < 3; ++c)
      E.col(c) =
          at(mesh_->rest_xyz, node[static_cast<std::size_t>(c) + 1]) - at(mesh_->rest_xyz, node[0]);
    return E;
  };
  Eigen::Matrix3f E = edges();
  if (E.determinant() < 0) {
    std::swap(node[1], node[2]);
    E = edges();
  }
  const float volume = E.determinant() / 6;
  if (!(volume > 1e-18F)) return;
  tetrahedra_.push_back({node, E.inverse(), volume});
  for (const std::int32_t n : node) node_volume_[static_cast<std::size_t>(n)] += volume;
}

template <class Value>
void FieldEvaluator::average(Value value_of_element, std::vector<float>& out) {
  out.assign(node_volume_.size(), 0.0F);
  for (std::size_t t = 0; t < tetrahedra_.size(); ++t) {
    const Tetrahedron& tetrahedron = tetrahedra_[t];
    const float value = value_of_element(t) * tetrahedron.volume;
    for (const std::int32_t n : tetrahedron.node) out[static_cast<std::size_t>(n)] += value;
  }
  for (std::size_t n = 0; n < out.size(); ++n)
    if (node_volume_[n] > 0) out[n] /= node_volume_[n];
}

void FieldEvaluator::displacement(const std::vector<float>& xyz, std::vector<float>& out) const {
  out.resize(node_volume_.size());
  for (std::size_t n = 0; n < out.size(); ++n) {
    const auto node = static_cast<std::int32_t>(n);
    out[n] = (at(xyz, node) - at(mesh_->rest_xyz, node)).norm();
  }
}

void FieldEvaluator::strain(const std::vector<float>& xyz, std::vector<float>& out) {
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> solver;
  average(
      [&](std::size_t t) {
        const Tetrahedron& tetrahedron = tetrahedra_[t];
        Eigen::Matrix3f edges;
        for (int c = 0; c < 3; ++c)
          edges.col(c) = at(xyz, tetrahedron.node[static_cast<std::size_t>(c) + 1]) -
                         at(xyz, tetrahedron.node[0]);
        const Eigen::Matrix3f F = edges * tetrahedron.inverse_edges;
        solver.computeDirect(F.transpose() * F, Eigen::EigenvaluesOnly);
        const float low = std::sqrt(std::max(0.0F, solver.eigenvalues()[0]));
        const float high = std::sqrt(std::max(0.0F, solver.eigenvalues()[2]));
        return std::max(std::fabs(low - 1), std::fabs(high - 1));
      },
      out);
}

void FieldEvaluator::stress(const std::vector<float>& xyz, double young_modulus,
                            double poisson_ratio, std::vector<float>& out) {
  constexpr double kSameRatio = 1e-3;
  if (!mechanics_ || std::fabs(mechanics_->poisson_ratio - poisson_ratio) > kSameRatio) {
    auto made = std::make_unique<Mechanics>();
    made->poisson_ratio = poisson_ratio;
    mesh::TetrahedralMesh mesh;
    mesh.nodes = Eigen::Matrix3Xf::Map(mesh_->rest_xyz.data(), 3, mesh_->node_count).cast<double>();
    mesh.tetrahedra.resize(4, static_cast<Eigen::Index>(tetrahedra_.size()));
    for (std::size_t t = 0; t < tetrahedra_.size(); ++t)
      mesh.tetrahedra.col(static_cast<Eigen::Index>(t)) =
          Eigen::Vector4i::Map(tetrahedra_[t].node.data());
    made->body.mesh = mesh::make_element_mesh(mesh, mesh::ElementOrder::kLinear);
    made->body.material = {1.0, poisson_ratio, 1.0};
    made->evaluator = elasticity::make_stress_evaluator(elasticity::ElementSet(made->body));
    mechanics_ = std::move(made);
  }
  Mechanics& m = *mechanics_;
  m.x = Eigen::Matrix3Xf::Map(xyz.data(), 3, mesh_->node_count).cast<double>();
  m.evaluator->evaluate(m.x, m.result);
  average(
      [&](std::size_t t) {
        return static_cast<float>(young_modulus * m.result.von_mises[static_cast<Eigen::Index>(t)]);
      },
      out);
}

}  // namespace palpate::view
