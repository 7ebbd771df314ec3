#include "sim/sensors/biotac_film.hpp"

#include <Eigen/Cholesky>
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

}  // namespace

const BiotacFilm& biotac_film() {
  static const BiotacFilm film = make_film();
  return film;
}

}  // namespace palpate::sensors
