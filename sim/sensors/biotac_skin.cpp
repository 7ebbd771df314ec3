#include "sim/sensors/biotac_skin.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/math/constants.hpp"

namespace palpate::sensors {
namespace {

using sensing::kElectrodeCount;
using sensing::kSkinRadius;

using math::kPi;
// Half a cylinder from its root to the sphere of the tip, then a quarter of that sphere.
constexpr double kLength = 16e-3;
constexpr int kAlong = 8, kRings = 5, kAround = 11;
constexpr int kRows = kAlong + kRings, kPatches = kRows * kAround;
constexpr double kElectrodeRadius = 1e-3;  // m, around the point where its current enters the fluid
constexpr double kGround = 1e3;  // conductance of excitation electrodes relative to the film's

// Lin, Fishel and Loeb 2013: X1 to X4, m.
const Eigen::Matrix<double, 3, 4> kExcitation =
    1e-3 * (Eigen::Matrix<double, 3, 4>() << -3.7, -15.9, -3.7, -15.9,  //
            -4.956, -3.589, 4.956, 3.589,                               //
            -1.116, -3.595, -1.116, -3.595)
               .finished();

int patch(int row, int column) { return row * kAround + column; }

/// Weights of the patches around a point of the core, by proximity; they sum to 1.
Eigen::VectorXd spread(const BiotacFilm& film, const Eigen::Vector3d& p) {
  const Eigen::Vector3d at = sensing::project_on_skin(p);
  Eigen::VectorXd weights = (-(film.points.colwise() - at).colwise().squaredNorm() /
                             (2 * kElectrodeRadius * kElectrodeRadius))
                                .array()
                                .exp()
                                .transpose();
  weights = weights.cwiseProduct(film.areas);
  return weights / weights.sum();
}

/// Links between patches and their conductance, in units of that of a square of film.
struct Links {
  struct Link {
    int a, b;
    double conductance;
  };
  std::vector<Link> list;
};

struct Grid {
  double along[kRows];   // m, extent of a row along the axis
  double around[kRows];  // m, width of a patch across it
};

Grid place_patches(BiotacFilm& film) {
  film.points.resize(3, kPatches);
  film.normals.resize(3, kPatches);
  film.areas.resize(kPatches);
  Grid grid;
  for (int row = 0; row < kRows; ++row) {
    const bool tip = row >= kAlong;
    const double tilt = tip ? (row - kAlong + 0.5) * kPi / 2 / kRings : 0;
    const double x = tip ? kSkinRadius * std::sin(tilt) : -kLength * (1 - (row + 0.5) / kAlong);
    const double ring = kSkinRadius * std::cos(tilt);
    grid.along[row] = tip ? kSkinRadius * kPi / 2 / kRings : kLength / kAlong;
    grid.around[row] = ring * kPi / kAround;
    for (int column = 0; column < kAround; ++column) {
      const double angle = ((column + 0.5) / kAround - 0.5) * kPi;
      const int p = patch(row, column);
      film.points.col(p) << x, ring * std::sin(angle), -ring * std::cos(angle);
      film.normals.col(p) = sensing::skin_normal(film.points.col(p));
      film.areas[p] = grid.along[row] * grid.around[row];
    }
  }
  return grid;
}

Links link_patches(const Grid& grid) {
  Links links;
  for (int row = 0; row < kRows; ++row)
    for (int column = 0; column < kAround; ++column) {
      if (column + 1 < kAround)
        links.list.push_back(
            {patch(row, column), patch(row, column + 1), grid.along[row] / grid.around[row]});
      if (row + 1 < kRows)
        links.list.push_back(
            {patch(row, column), patch(row + 1, column),
             (grid.around[row] + grid.around[row + 1]) / (grid.along[row] + grid.along[row + 1])});
    }
  return links;
}

BiotacFilm make_film() {
  BiotacFilm film;
  const Links links = link_patches(place_patches(film));
  Eigen::MatrixXd conductance = Eigen::MatrixXd::Zero(kPatches, kPatches);
  for (const Links::Link& link : links.list) {
    conductance(link.a, link.a) += link.conductance;
    conductance(link.b, link.b) += link.conductance;
    conductance(link.a, link.b) -= link.conductance;
    conductance(link.b, link.a) -= link.conductance;
  }
  for (int x = 0; x < kExcitation.cols(); ++x)
    conductance.diagonal() += kGround * spread(film, kExcitation.col(x));
  const Eigen::LLT<Eigen::MatrixXd> solver(conductance);

  film.shares = Eigen::MatrixXd::Zero(kElectrodeCount, kPatches);
  for (int i = 0; i < kElectrodeCount; ++i) {
    const Eigen::VectorXd potential =
        solver.solve(spread(film, sensing::electrode_positions().col(i)));
    for (const Links::Link& link : links.list) {
      const double drop = potential[link.a] - potential[link.b];
      film.shares(i, link.a) += 0.5 * link.conductance * drop * drop;
      film.shares(i, link.b) += 0.5 * link.conductance * drop * drop;
    }
    film.shares.row(i) /= film.shares.row(i).sum();
  }
  return film;
}

using Eigen::ArrayXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

using math::kPi;
// Fractions of the rest depth: folds of the skin keep the film open, the nail limits bulges.
constexpr double kLeastDepth = 0.05, kMostDepth = 1.5;

ArrayXd bell(const Vector3d& centre, double variance) {
  return (-(biotac_film().points.colwise() - centre).colwise().squaredNorm() / (2 * variance))
      .array()
      .exp()
      .transpose();
}

Vector3d normal_at(const Touch& touch) {
  return sensing::skin_normal(sensing::project_on_skin(touch.location_T));
}

double pressing_of(const Touch& touch) {
  return std::max(0.0, -touch.force_T.dot(normal_at(touch)));
}

}  // namespace

const BiotacFilm& biotac_film() {
  static const BiotacFilm film = make_film();
  return film;
}

double pressing_force(const std::vector<Touch>& touches) {
  double sum = 0;
  for (const Touch& touch : touches) sum += pressing_of(touch);
  return sum;
}

BiotacSkin::BiotacSkin(const SkinTable& table)
    : table_(table),
      played_(VectorXd::Zero(biotac_film().areas.size())),
      fast_(played_),
      slow_(played_) {}

VectorXd BiotacSkin::equilibrium(const std::vector<Touch>& touches) const {
  const BiotacFilm& film = biotac_film();
  VectorXd dent = VectorXd::Zero(film.areas.size());
  for (const Touch& touch : touches) {
    const double pressing = pressing_of(touch);
    if (pressing == 0) continue;
    const Vector3d at = sensing::project_on_skin(touch.location_T);
    const Vector3d shear = touch.force_T + pressing * sensing::skin_normal(at);
    const Vector3d centre = sensing::project_on_skin(at + shear / table_.shear_stiffness);
    const double variance = 0.5 * touch.radius * touch.radius + table_.spread * table_.spread;
    const double area = 2 * kPi * variance;
    // Progressive springs that cannot be compressed completely.
    const double depth =
        kFilmDepth * (1 - std::exp(-pressing / (table_.foundation * area * kFilmDepth)));
    dent.array() += depth * bell(centre, variance);
    // Shear of the skin brings it nearer to the core on one side and farther from it on the other.
    const ArrayXd shift = (film.normals.transpose() * (centre - at)).array();
    dent.array() -= bell(at, table_.shear_reach * table_.shear_reach) * shift;
  }
  dent.array() -= table_.bulge * dent.dot(film.areas) / film.areas.sum();
  return dent;
}

void BiotacSkin::step(double dt, const std::vector<Touch>& touches) {
  const VectorXd pressed = equilibrium(touches);
  played_ = played_.cwiseMax((pressed.array() - table_.friction).matrix())
                .cwiseMin((pressed.array() + table_.friction).matrix());
  fast_ += (1 - std::exp(-dt / table_.fast_time)) * (played_ - fast_);
  slow_ += (1 - std::exp(-dt / table_.slow_time)) * (played_ - slow_);
}

VectorXd BiotacSkin::dent() const {
  const double at_once = 1 - table_.fast_share - table_.slow_share;
  return at_once * played_ + table_.fast_share * fast_ + table_.slow_share * slow_;
}

sensing::ElectrodeVector BiotacSkin::resistance() const {
  const ArrayXd depth = (1 - dent().array() / kFilmDepth).max(kLeastDepth).min(kMostDepth);
  return biotac_film().shares * depth.inverse().matrix();
}

}  // namespace palpate::sensors
