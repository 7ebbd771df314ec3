#include "sim/sensors/biotac_skin.hpp"

#include <algorithm>
#include <cmath>

#include "core/math/constants.hpp"
#include "sim/sensors/biotac_film.hpp"

namespace palpate::sensors {
namespace {

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
