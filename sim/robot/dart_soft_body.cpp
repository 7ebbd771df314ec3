#include "sim/robot/dart_soft_body.hpp"

#include <algorithm>
#include <dart/collision/CollisionObject.hpp>
#include <dart/collision/CollisionResult.hpp>
#include <dart/collision/fcl/FCLCollisionDetector.hpp>
#include <dart/constraint/ConstraintSolver.hpp>
#include <dart/dynamics/BoxShape.hpp>
#include <dart/dynamics/FreeJoint.hpp>
#include <dart/dynamics/PointMass.hpp>
#include <dart/dynamics/Skeleton.hpp>
#include <dart/dynamics/SoftBodyNode.hpp>
#include <dart/dynamics/SphereShape.hpp>
#include <dart/dynamics/TranslationalJoint.hpp>
#include <dart/simulation/World.hpp>
#include <iostream>
#include <memory>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "sim/robot/dart_options.hpp"

namespace palpate::robot {
namespace dd = dart::dynamics;
namespace {

constexpr int kMostVertices = 230;
constexpr double kHoldMoving = 1e5;   // N/m
constexpr double kHoldTurning = 1e3;  // N m/rad
/// The core's own mass: negligible, the vertices carry the mass.
constexpr double kCoreMass = 1e-6, kCoreMoment = 1e-9;

/// The only DART detector that supports soft meshes, and only against other meshes. DART's own
/// detector generates three times as many contact points for the same force and makes the step
/// three times as long; FCL's points are free of the FCL 0.3 defect that DART still warns about.
std::shared_ptr<dart::collision::CollisionDetector> make_detector() {
  using Detector = dart::collision::FCLCollisionDetector;
  const auto detector = Detector::create();
  detector->setPrimitiveShapeType(Detector::MESH);
  std::stringbuf unheard;
  std::streambuf* const heard = std::cerr.rdbuf(&unheard);
  detector->setContactPointComputationMethod(Detector::FCL);
  std::cerr.rdbuf(heard);
  return detector;
}

void check(const SoftBoxOptions& o) {
  const auto require = [](bool good, const char* what) {
    if (!good) throw std::invalid_argument(std::string("a soft box needs ") + what);
  };
  require((o.size.array() > 0).all(), "edges above zero");
  require((o.vertices.array() >= 3).all(), "3 vertices along each edge at least");
  const Eigen::Array3i n = o.vertices.array();
  require(n.prod() - (n - 2).prod() <= kMostVertices, "230 vertices at most");
  require(o.mass > 0, "a mass above zero");
  require(o.vertex_stiffness > 0 && o.edge_stiffness >= 0 && o.damping >= 0,
          "a vertex stiffness above zero, edge stiffness and damping not below");
  require(o.friction >= 0, "a friction coefficient of zero or above");
}

}  // namespace

struct DartSoftBody::Dynamics {
  dart::simulation::WorldPtr world = dart::simulation::World::create();
  dd::SkeletonPtr box = dd::Skeleton::create("box");
  dd::SoftBodyNode* soft = nullptr;
  std::vector<dd::SkeletonPtr> probes;
  double friction = 0;
  Eigen::Matrix3Xd positions;
  Eigen::Matrix3Xi triangles;
  std::vector<ProbeContact> touches;   // of each probe
  std::vector<Eigen::Vector3d> pulls;  // on each vertex
  int contacts = 0;

  /// DART treats a soft body on a weld joint as one that cannot react, so stiff springs (integrated
  /// implicitly) hold the core instead.
  static void hold(dd::FreeJoint& joint) {
    for (std::size_t i = 0; i < 6; ++i) {  // rotations first
      joint.setSpringStiffness(i, i < 3 ? kHoldTurning : kHoldMoving);
      joint.setDampingCoefficient(i, 1e-3 * joint.getSpringStiffness(i));
    }
  }

  /// DART 6.12 creates a box without the springs along its edges.
  void join_edges() {
    std::set<std::pair<int, int>> edges;
    for (int t = 0; t < triangles.cols(); ++t)
      for (int e = 0; e < 3; ++e)
        edges.insert(std::minmax<int>(triangles(e, t), triangles((e + 1) % 3, t)));
    for (const auto& [a, b] : edges) soft->connectPointMasses(a, b);
  }

  /// DART 6.12 orients a few triangles of a box the wrong way round.
  void turn_outward(const Eigen::Vector3d& middle) {
    for (int t = 0; t < triangles.cols(); ++t) {
      const Eigen::Vector3d a = positions.col(triangles(0, t));
      const Eigen::Vector3d b = positions.col(triangles(1, t)), c = positions.col(triangles(2, t));
      if ((b - a).cross(c - a).dot(a - middle) < 0) std::swap(triangles(0, t), triangles(1, t));
    }
  }

  void make_box(const SoftBoxOptions& o) {
    const auto shape = dd::SoftBodyNodeHelper::makeBoxProperties(
        o.size, Eigen::Isometry3d::Identity(), o.vertices, o.mass, o.vertex_stiffness,
        o.edge_stiffness, o.damping);
    const dd::SoftBodyNode::Properties properties(dd::BodyNode::AspectProperties("soft"), shape);
    dd::FreeJoint::Properties joint;
    joint.mT_ParentBodyToJoint.translation() = o.size / 2;
    const auto made = box->createJointAndBodyNodePair<dd::FreeJoint, dd::SoftBodyNode>(
        nullptr, joint, properties);
    soft = made.second;
    hold(*made.first);
    dd::Inertia inertia;
    inertia.setMass(kCoreMass);
    inertia.setMoment(kCoreMoment * Eigen::Matrix3d::Identity());
    soft->setInertia(inertia);
    for (dd::ShapeNode* node : soft->getShapeNodesWith<dd::DynamicsAspect>())
      node->getDynamicsAspect()->setFrictionCoeff(o.friction);
    world->addSkeleton(box);
    triangles.resize(3, soft->getNumFaces());
    for (std::size_t i = 0; i < soft->getNumFaces(); ++i) triangles.col(i) = soft->getFace(i);
    join_edges();
    positions.resize(3, soft->getNumPointMasses());
    read_positions();
    turn_outward(o.size / 2);
    pulls.assign(soft->getNumPointMasses(), Eigen::Vector3d::Zero());
  }

  void give_shape(dd::BodyNode* body, const dd::ShapePtr& shape) const {
    auto* node = body->createShapeNodeWith<dd::CollisionAspect, dd::DynamicsAspect>(shape);
    node->getDynamicsAspect()->setFrictionCoeff(friction);
  }

  int add_probe(const dd::ShapePtr& shape, const Eigen::Vector3d& position) {
    dd::SkeletonPtr probe = dd::Skeleton::create("probe " + std::to_string(probes.size()));
    const auto made = probe->createJointAndBodyNodePair<dd::TranslationalJoint>();
    give_shape(made.second, shape);
    made.first->setActuatorType(dd::Joint::VELOCITY);
    for (int i = 0; i < 3; ++i) made.first->setPosition(i, position(i));
    made.second->setGravityMode(false);
    world->addSkeleton(probe);
    probes.push_back(probe);
    touches.emplace_back();
    return static_cast<int>(probes.size()) - 1;
  }

  std::size_t owner(const dart::collision::CollisionObject* object) const {
    const auto* node = dynamic_cast<const dd::ShapeNode*>(object->getShapeFrame());
    const dd::Skeleton* skeleton = node ? node->getSkeleton().get() : nullptr;
    for (std::size_t i = 0; i < probes.size(); ++i)
      if (probes[i].get() == skeleton) return i;
    return probes.size();
  }

  void apply_pulls() {
    for (std::size_t i = 0; i < pulls.size(); ++i) {
      soft->getPointMass(i)->clearExtForce();
      soft->getPointMass(i)->addExtForce(pulls[i]);
    }
  }

  /// A contact's force acts on its first object, the opposite force on the second.
  void sum_forces() {
    std::fill(touches.begin(), touches.end(), ProbeContact());
    std::vector<double> weights(touches.size(), 0.0);
    const auto add = [&](std::size_t who, const Eigen::Vector3d& force,
                         const dart::collision::Contact& contact) {
      if (who >= touches.size()) return;
      touches[who].force += force;
      touches[who].point += force.norm() * contact.point;
      touches[who].depth = std::max(touches[who].depth, contact.penetrationDepth);
      weights[who] += force.norm();
    };
    const auto& result = world->getLastCollisionResult();
    contacts = static_cast<int>(result.getNumContacts());
    for (const auto& contact : result.getContacts()) {
      add(owner(contact.collisionObject1), contact.force, contact);
      add(owner(contact.collisionObject2), -contact.force, contact);
    }
    for (std::size_t i = 0; i < touches.size(); ++i)
      if (weights[i] > 0) touches[i].point /= weights[i];
  }

  void read_positions() {
    for (int i = 0; i < positions.cols(); ++i)
      positions.col(i) = soft->getPointMass(i)->getWorldPosition();
  }
};

DartSoftBody::DartSoftBody(const SoftBoxOptions& options)
    : dynamics_(std::make_unique<Dynamics>()) {
  check(options);
  Dynamics& d = *dynamics_;
  d.world->getConstraintSolver()->setCollisionDetector(make_detector());
  d.world->setGravity(options.gravity_O);
  d.friction = options.friction;
  d.make_box(options);
  d.read_positions();
}

DartSoftBody::~DartSoftBody() = default;

int DartSoftBody::add_sphere(double radius, const Eigen::Vector3d& position) {
  return dynamics_->add_probe(std::make_shared<dd::SphereShape>(radius), position);
}

int DartSoftBody::add_plate(const Eigen::Vector3d& size, const Eigen::Vector3d& position) {
  return dynamics_->add_probe(std::make_shared<dd::BoxShape>(size), position);
}

void DartSoftBody::move(int probe, const Eigen::Vector3d& velocity) {
  dd::SkeletonPtr& skeleton = dynamics_->probes.at(probe);
  for (int i = 0; i < 3; ++i) skeleton->getDof(i)->setCommand(velocity(i));
}

void DartSoftBody::pull(int vertex, const Eigen::Vector3d& force) {
  dynamics_->pulls.at(vertex) = force;
}

void DartSoftBody::step(double dt) {
  Dynamics& d = *dynamics_;
  d.apply_pulls();
  d.world->setTimeStep(dt);
  d.world->step(false);  // a probe's commanded velocity persists
  d.sum_forces();
  d.read_positions();
}

std::string DartSoftBody::effective_options() const {
  const Dynamics& d = *dynamics_;
  return robot::effective_options(*d.world) + "; skin of " +
         std::to_string(d.soft->getNumPointMasses()) + " masses, stiffness " +
         std::to_string(d.soft->getVertexSpringStiffness()) + " N/m to the core and " +
         std::to_string(d.soft->getEdgeSpringStiffness()) + " N/m along edges, damping " +
         std::to_string(d.soft->getDampingCoefficient());
}

int DartSoftBody::vertex_count() const { return static_cast<int>(dynamics_->positions.cols()); }
const Eigen::Matrix3Xd& DartSoftBody::positions() const { return dynamics_->positions; }
const Eigen::Matrix3Xi& DartSoftBody::surface_triangles() const { return dynamics_->triangles; }
math::Pose DartSoftBody::core() const { return dynamics_->soft->getWorldTransform(); }

Eigen::Vector3d DartSoftBody::probe_position(int probe) const {
  return dynamics_->probes.at(probe)->getBodyNode(0)->getWorldTransform().translation();
}
const ProbeContact& DartSoftBody::probe_contact(int probe) const {
  return dynamics_->touches.at(probe);
}
int DartSoftBody::contact_count() const { return dynamics_->contacts; }

}  // namespace palpate::robot
