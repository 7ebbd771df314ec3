#include "tools/lab/baselines/sensing/evolved_mass_spring.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace palpate::baselines {
namespace {

using Eigen::Vector3d;

constexpr double kGrip = 20;  // stiffness of the hand's springs relative to a lattice edge
// Weight of a node relative to the force of a spring stretched by one edge, for a gene of 0.
constexpr double kWeight = 1e-3;
constexpr double kFarthest = 3;  // limit of a gene

}  // namespace

EvolvedMassSpring::EvolvedMassSpring(const elasticity::Body& body, const mesh::Surface& surface,
                                     const Options& options)
    : CloudEstimator(body, surface, options),
      options_(options),
      voxels_(body, options.voxel),
      random_(1, "evolution"),
      edge_(options.voxel) {
  if (options.population < 3 || !(options.generation > 0) || !(options.mutation > 0) ||
      !(options.damping > 0) || !(options.damping < 1))
    throw std::invalid_argument(
        "evolution wants a population of 3 at least, generation and mutation > 0, damping in "
        "(0, 1)");
  if (body.gravity_O.norm() > 0) down_ = body.gravity_O.normalized();
  creatures_.resize(static_cast<std::size_t>(options.population));
  force_.setZero(3, voxels_.rest().cols());
  pull_.setZero(3, body.mesh.node_count());
  for (Creature& creature : creatures_) {
    creature.lattice = voxels_.rest();
    creature.velocity = force_;
    creature.shape = body.mesh.nodes;
  }
}

void EvolvedMassSpring::begin(const Eigen::Matrix3Xd&) noexcept {
  random_ = math::Random(1, "evolution");
  for (Creature& creature : creatures_) {
    for (double& gene : creature.genes) gene = random_.normal();
    creature.lattice = voxels_.rest();
    creature.velocity.setZero();
    voxels_.embed(creature.lattice, creature.shape);
    creature.squared = 0;
    creature.looks = 0;
  }
  creatures_[0].genes.setZero();
  best_ = generations_ = 0;
  since_ = 0;
}

void EvolvedMassSpring::take(elasticity::DeformationModel&) noexcept {
  if (matches().count() == 0) return;
  for (Creature& creature : creatures_) {
    double squared = 0;
    for (int i = 0; i < matches().count(); ++i) {
      const CloudMatch& match = matches()[i];
      squared += std::pow(match.place.normal.dot(match.point - match.of(creature.shape)), 2);
    }
    creature.squared += squared / matches().count();
    ++creature.looks;
  }
}

/// The worst model is replaced by a child of the best and another one, starting from the best one's
/// shape.
void EvolvedMassSpring::breed() noexcept {
  since_ = 0;
  if (creatures_[0].looks == 0) return;
  const auto worse = [](const Creature& a, const Creature& b) { return a.squared < b.squared; };
  const auto [least, most] = std::minmax_element(creatures_.begin(), creatures_.end(), worse);
  best_ = static_cast<int>(least - creatures_.begin());
  const Creature& other = creatures_[random_.below(creatures_.size())];
  if (most != least) {
    for (int i = 0; i < 3; ++i) {
      const double inherited = random_.uniform() < 0.7 ? least->genes[i] : other.genes[i];
      most->genes[i] =
          std::clamp(inherited + options_.mutation * random_.normal(), -kFarthest, kFarthest);
    }
    most->lattice = least->lattice;
    most->velocity = least->velocity;
  }
  ++generations_;
  for (Creature& creature : creatures_) {
    creature.squared = 0;
    creature.looks = 0;
  }
}

/// One tick, as in VoxelMassSpring: a mass is twice the sum of its node's spring stiffnesses.
void EvolvedMassSpring::live(Creature& creature,
                             const elasticity::DeformationModel& model) noexcept {
  const elasticity::Body& body = model.body();
  const std::array<double, 3> stiffness{1, std::exp(creature.genes[0]),
                                        std::exp(creature.genes[1])};
  // Sum of a node's spring stiffnesses.
  const double largest = 6 + 12 * stiffness[1] + 8 * stiffness[2];
  pull_.setZero();
  for (int g = 0; g < static_cast<int>(body.grasps.size()); ++g) {
    if (!model.is_held(g)) continue;
    for (const int node : body.grasps[g].nodes)
      pull_.col(node) = kGrip * (held_place(g, node, body) - creature.shape.col(node));
  }
  force_.colwise() = kWeight * std::exp(creature.genes[2]) * edge_ * down_;
  voxels_.spread(pull_, force_);
  for (const VoxelLattice::Spring& s : voxels_.springs()) {
    const Vector3d d = creature.lattice.col(s.a) - creature.lattice.col(s.b);
    const Vector3d f =
        stiffness[static_cast<std::size_t>(s.kind)] * (1 - s.length / std::max(d.norm(), 1e-9)) * d;
    force_.col(s.a) -= f;
    force_.col(s.b) += f;
  }
  // the hand's springs are as stiff as several of the lattice's
  creature.velocity =
      (1 - options_.damping) * (creature.velocity + force_ / (2 * (largest + kGrip)));
  creature.lattice += creature.velocity;
  for (const int node : voxels_.fixed()) {
    creature.lattice.col(node) = voxels_.rest().col(node);
    creature.velocity.col(node).setZero();
  }
  voxels_.embed(creature.lattice, creature.shape);
}

elasticity::StepReport EvolvedMassSpring::advance(double dt, const estimation::EstimationInputs&,
                                                  elasticity::DeformationModel& model) noexcept {
  since_ += dt;
  if (since_ >= options_.generation) breed();
  for (Creature& creature : creatures_) live(creature, model);
  return carry(creatures_[best_].shape, model);
}

}  // namespace palpate::baselines
