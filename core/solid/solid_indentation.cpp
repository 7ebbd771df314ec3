#include "core/solid/solid_indentation.hpp"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "core/solid/solid_quadrilateral.hpp"

namespace palpate::solid {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::VectorXd;
using Local = Eigen::Matrix<double, 18, 1>;
using LocalMatrix = Eigen::Matrix<double, 18, 18>;
// Derivative of F, axes r, z, circumferential, with respect to (r, z) of each node.
using LayerStrain = Eigen::Matrix<double, 9, 18>;

constexpr double kPenalty = 2000;  // N/m^3 divided by (Young's modulus / R): penetration of 1e-3 R
/// Grid lines from 0 to `length` whose spacing starts with `first` and grows by the factor
/// `growth`.
std::vector<double> graded(double length, double first, double growth) {
  std::vector<double> sizes;
  double sum = 0;
  for (double size = first; sum < length; size *= growth) {
    sizes.push_back(size);
    sum += size;
  }
  std::vector<double> lines = {0};
  for (double size : sizes) lines.push_back(lines.back() + size * length / sum);
  return lines;
}

class Layer {
 public:
  Layer(const SolidCoefficients& c, double thickness, double finest) : c_(c) {
    const std::vector<double> r = graded(std::max(10.0, 3 * thickness), finest, 1.13);
    const std::vector<double> z = graded(thickness, finest, 1.25);  // downwards from the surface
    columns_ = static_cast<int>(r.size()) - 1;
    rows_ = static_cast<int>(z.size()) - 1;
    across_ = 2 * columns_ + 1;
    const int down = 2 * rows_ + 1;
    rest_.resize(2, across_ * down);
    const auto at = [](const std::vector<double>& lines, int k) {
      return k % 2 == 0 ? lines[k / 2] : 0.5 * (lines[k / 2] + lines[k / 2 + 1]);
    };
    unknown_.assign(rest_.size(), -1);
    for (int j = 0; j < down; ++j) {
      for (int i = 0; i < across_; ++i) {
        const int node = i + across_ * j;
        rest_.col(node) << at(r, i), -at(z, j);
        if (j == down - 1) continue;  // bonded to the ground
        if (i > 0) unknown_[2 * node] = size_++;
        unknown_[2 * node + 1] = size_++;
      }
    }
    u_ = VectorXd::Zero(rest_.size());
    for (int e = 0; e < columns_ * rows_; ++e) {
      elements_.push_back(make_element(e));
      rounding_ += 1e-15 * young() * elements_.back().volume;
    }
  }

  /// Presses the ball to `depth`; false if no equilibrium is found, with the layer unchanged.
  bool press(double depth) {
    const VectorXd begin = u_;
    foresee(depth - depth_);
    depth_ = depth;
    if (!std::isfinite(evaluate(u_, nullptr, nullptr))) u_ = begin;
    VectorXd forces;
    double energy = evaluate(u_, &forces, nullptr);
    for (int iteration = 0; iteration < 60 && std::isfinite(energy); ++iteration) {
      const VectorXd step = newton_step(u_, forces);
      if (step.size() == 0) break;
      const double descent = forces.dot(step);
      // near convergence points alternate between contact and no contact, below any relevant
      // accuracy
      if (std::abs(descent) < 1e-11 * energy) return true;
      if (forces.cwiseAbs().maxCoeff() < 1e-6 * force()) return true;
      const VectorXd from = u_;
      const double imbalance = forces.cwiseAbs().maxCoeff();
      double next = std::numeric_limits<double>::infinity();
      for (double alpha = 1; alpha > 1e-4; alpha /= 2) {
        u_ = from;
        add(alpha * step, u_);
        next = evaluate(u_, &forces, nullptr);
        // Where rounding errors exceed the decrease of the energy, the forces decide.
        if (next <= energy + 1e-4 * alpha * descent ||
            (next <= energy + rounding_ && forces.cwiseAbs().maxCoeff() < imbalance)) {
          break;
        }
        next = std::numeric_limits<double>::infinity();
      }
      energy = next;
    }
    u_ = begin;
    return false;
  }

  /// Force on the ball, upwards.
  double force() const {
    double sum = 0;
    contact(u_, [&](const std::array<int, 3>&, const std::array<double, 3>&, double pressure,
                    const Vector2d& normal, double, double) { sum -= pressure * normal.y(); });
    return sum;
  }

 private:
  struct Point {
    LayerStrain strain;
    double weight = 0;  // volume, m^3
  };
  struct Element {
    std::array<int, 9> nodes{};
    std::array<Point, 9> points;
    double volume = 0;
  };

  Element make_element(int e) const {
    Element element;
    const int i = 2 * (e % columns_), j = 2 * (e / columns_);
    for (int a = 0; a < 9; ++a) element.nodes[a] = i + a % 3 + across_ * (j + a / 3);
    // rectangles: r along the first index, depth along the second
    const double width = rest_(0, element.nodes[2]) - rest_(0, element.nodes[0]);
    const double height = rest_(1, element.nodes[6]) - rest_(1, element.nodes[0]);  // < 0
    const double middle = rest_(0, element.nodes[1]);
    for (int p = 0; p < 9; ++p) {
      const double s = kGaussPoints[p % 3], t = kGaussPoints[p / 3], r = middle + s * width / 2;
      const auto ns = line_shape(s), nt = line_shape(t), ds = line_slope(s), dt = line_slope(t);
      Point& point = element.points[p];
      point.strain.setZero();
      for (int a = 0; a < 9; ++a) {
        const double by_r = ds[a % 3] * nt[a / 3] * 2 / width;
        const double by_z = ns[a % 3] * dt[a / 3] * 2 / height;
        point.strain(0, 2 * a) = point.strain(1, 2 * a + 1) = by_r;  // column r of F
        point.strain(3, 2 * a) = point.strain(4, 2 * a + 1) = by_z;
        point.strain(8, 2 * a) = ns[a % 3] * nt[a / 3] / r;
      }
      point.weight =
          2 * M_PI * r * std::abs(width * height) / 4 * kGaussWeights[p % 3] * kGaussWeights[p / 3];
      element.volume += point.weight;
    }
    return element;
  }

  /// Predicts the shape after the ball has moved by `deeper` with the present contact points, using
  /// the present factor.
  void foresee(double deeper) {
    VectorXd push = VectorXd::Zero(size_);
    contact(u_, [&](const std::array<int, 3>& nodes, const std::array<double, 3>& n, double,
                    const Vector2d& normal, double stiffness, double) {
      Eigen::Matrix<double, 6, 1> f;
      for (int a = 0; a < 3; ++a) {
        f.segment<2>(2 * a) = -normal.y() * stiffness * deeper * n[a] * normal;
      }
      scatter(nodes, f, push);
    });
    if (push.squaredNorm() > 0) add(factor_.solve(push), u_);
  }

  void add(const VectorXd& step, VectorXd& u) const {
    for (std::size_t k = 0; k < unknown_.size(); ++k) {
      if (unknown_[k] >= 0) u[k] += step[unknown_[k]];
    }
  }

  /// Calls f(nodes, shape, force along the normal, normal away from the ball, stiffness, distance
  /// from the ball's centre) for each surface point in contact with the ball.
  template <class Function>
  void contact(const VectorXd& u, const Function& f) const {
    for (int e = 0; e < columns_; ++e) {
      const std::array<int, 3> nodes = {2 * e, 2 * e + 1, 2 * e + 2};
      const double width = rest_(0, nodes[2]) - rest_(0, nodes[0]);
      if (rest_(0, nodes[0]) > 3) break;
      for (int p = 0; p < 3; ++p) {
        const auto n = line_shape(kGaussPoints[p]);
        Vector2d x = Vector2d::Zero();
        double r = 0;
        for (int a = 0; a < 3; ++a) {
          x += n[a] * (rest_.col(nodes[a]) + u.segment<2>(2 * nodes[a]));
          r += n[a] * rest_(0, nodes[a]);
        }
        const Vector2d arm = x - Vector2d(0, 1 - depth_);
        const double distance = arm.norm(), dent = 1 - distance;
        if (dent <= 0) continue;
        const double stiffness = kPenalty * young() * 2 * M_PI * r * width / 2 * kGaussWeights[p];
        f(nodes, n, stiffness * dent, Vector2d(arm / distance), stiffness, distance);
      }
    }
  }

  /// Young's modulus at small strain, for scaling.
  double young() const { return 6 * (c_.c10 + c_.c01); }

  /// Energy at u; unbalanced forces over the unknowns and triplets of the tangent, if requested.
  double evaluate(const VectorXd& u, VectorXd* forces,
                  std::vector<Eigen::Triplet<double>>* tangent) const {
    double energy = 0;
    if (forces) forces->setZero(size_);
    PointResponse response;
    Matrix3d cofactors;
    Eigen::Matrix<double, 9, 9> second;
    for (const Element& element : elements_) {
      Local local;
      for (int a = 0; a < 9; ++a) local.segment<2>(2 * a) = u.segment<2>(2 * element.nodes[a]);
      std::array<Matrix3d, 9> F;
      double mean = 0;
      Local of_volume = Local::Zero();
      for (int p = 0; p < 9; ++p) {
        const Point& point = element.points[p];
        Eigen::Map<Eigen::Matrix<double, 9, 1>>(F[p].data()) = point.strain * local;
        F[p] += Matrix3d::Identity();
        mean += point.weight / element.volume * volume_ratio(F[p], cofactors);
        of_volume += point.weight * point.strain.transpose() *
                     Eigen::Map<Eigen::Matrix<double, 9, 1>>(cofactors.data());
      }
      const double pressure = c_.bulk_mean * (mean - 1);
      energy += 0.5 * element.volume * pressure * (mean - 1);
      Local f = pressure * of_volume;
      LocalMatrix K;
      if (tangent) K = c_.bulk_mean / element.volume * of_volume * of_volume.transpose();
      for (int p = 0; p < 9; ++p) {
        const Point& point = element.points[p];
        if (!point_response(F[p], c_, tangent != nullptr, response)) {
          return std::numeric_limits<double>::infinity();
        }
        energy += point.weight * response.energy;
        f += point.weight * point.strain.transpose() *
             Eigen::Map<Eigen::Matrix<double, 9, 1>>(response.stress.data());
        if (!tangent) continue;
        volume_ratio(F[p], cofactors, &second);
        second = point.weight * (response.tangent + pressure * second);
        K.noalias() += point.strain.transpose() * (second * point.strain);
      }
      if (forces) scatter(element.nodes, f, *forces);
      if (tangent) scatter(element.nodes, K, *tangent);
    }
    contact(u, [&](const std::array<int, 3>& nodes, const std::array<double, 3>& n, double force,
                   const Vector2d& normal, double stiffness, double distance) {
      energy += 0.5 * force * force / stiffness;
      Eigen::Matrix<double, 6, 1> f;
      for (int a = 0; a < 3; ++a) f.segment<2>(2 * a) = -force * n[a] * normal;
      if (forces) scatter(nodes, f, *forces);
      if (!tangent) return;
      const Eigen::Matrix2d along = normal * normal.transpose();
      const Eigen::Matrix2d block =
          stiffness * along - force / distance * (Eigen::Matrix2d::Identity() - along);
      Eigen::Matrix<double, 6, 6> K;
      for (int a = 0; a < 3; ++a) {
        for (int b = 0; b < 3; ++b) K.block<2, 2>(2 * a, 2 * b) = n[a] * n[b] * block;
      }
      scatter(nodes, K, *tangent);
    });
    return energy;
  }

  template <std::size_t kNodes, class Vector>
  void scatter(const std::array<int, kNodes>& nodes, const Vector& f, VectorXd& forces) const {
    for (std::size_t a = 0; a < 2 * kNodes; ++a) {
      const int k = unknown_[2 * nodes[a / 2] + a % 2];
      if (k >= 0) forces[k] += f[a];
    }
  }

  template <std::size_t kNodes, class Matrix>
  void scatter(const std::array<int, kNodes>& nodes, const Matrix& K,
               std::vector<Eigen::Triplet<double>>& tangent) const {
    for (std::size_t a = 0; a < 2 * kNodes; ++a) {
      const int k = unknown_[2 * nodes[a / 2] + a % 2];
      for (std::size_t b = 0; k >= 0 && b < 2 * kNodes; ++b) {
        const int l = unknown_[2 * nodes[b / 2] + b % 2];
        if (l >= 0 && k >= l) {
          tangent.emplace_back(k, l, K(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b)));
        }
      }
    }
  }

  /// Empty if the tangent is not positive definite even after regularisation.
  VectorXd newton_step(const VectorXd& u, const VectorXd& forces) {
    std::vector<Eigen::Triplet<double>> triplets;
    evaluate(u, nullptr, &triplets);
    Eigen::SparseMatrix<double> K(size_, size_);
    K.setFromTriplets(triplets.begin(), triplets.end());
    if (!is_analysed_) factor_.analyzePattern(K);
    is_analysed_ = true;
    const double largest = K.diagonal().maxCoeff();
    for (double shift = 0; shift < 0.1; shift = std::max(1e-6, 10 * shift)) {
      factor_.setShift(shift * largest);
      factor_.factorize(K);
      if (factor_.info() == Eigen::Success) return factor_.solve(-forces);
    }
    return {};
  }

  SolidCoefficients c_;
  int columns_ = 0, rows_ = 0, across_ = 0, size_ = 0;
  double depth_ = 0, rounding_ = 0;
  Eigen::Matrix2Xd rest_;  // (r, z) of the nodes, row by row downwards from the surface z = 0
  std::vector<int> unknown_;
  std::vector<Element> elements_;
  VectorXd u_;
  bool is_analysed_ = false;
  Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> factor_;
};

}  // namespace

IndentationCurve indent_layer(const SolidCoefficients& c, double thickness,
                              const IndentationOptions& options) {
  if (!(thickness > 0.1 && thickness < 1e3) || !(options.deepest > 0) || options.steps < 2) {
    throw std::invalid_argument(
        "a layer needs a thickness between 0.1 and 1000 radii of the ball, and depths to reach");
  }
  Layer layer(c, thickness, options.finest);
  std::vector<double> depths, forces;
  for (int k = 1; k <= options.steps; ++k) {
    const double share = static_cast<double>(k) / options.steps;
    const double depth = options.deepest * share * share;
    if (!layer.press(depth)) break;
    depths.push_back(depth);
    forces.push_back(layer.force());
  }
  IndentationCurve curve;
  const auto count = static_cast<Eigen::Index>(depths.size());
  curve.depth = Eigen::Map<VectorXd>(depths.data(), count);
  curve.force = Eigen::Map<VectorXd>(forces.data(), count);
  return curve;
}

}  // namespace palpate::solid
