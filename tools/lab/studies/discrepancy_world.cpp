#include "tools/lab/studies/discrepancy_world.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/math/constants.hpp"
#include "rt/config/node.hpp"
#include "rt/registry/frames.hpp"
#include "sim/scenes/scene.hpp"
#include "tools/common/output_files.hpp"
#include "tools/common/table.hpp"
#include "tools/lab/uncertainty/drawn_error.hpp"
#include "tools/lab/uncertainty/draws_command.hpp"

namespace palpate::studies {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

constexpr double kDelay = 1;        // s, before the first pose
constexpr double kAfterLast = 0.5;  // s, after the last
constexpr int kLegs = 5;
constexpr DrawnRange kMove{1.5, 3}, kHold{1, 2.5};  // s
constexpr double kPadDamping = 20;                  // N s/m, of a sprung clamp
constexpr double kBeyond = 1;                       // m, out of any object

std::string text_of(double value) { return common::formatted("%.9g", value); }

std::string text_of(const Vector3d& v) {
  return "[" + text_of(v.x()) + ", " + text_of(v.y()) + ", " + text_of(v.z()) + "]";
}

/// A pose of the hand, as an item of motion.poses.
struct DrawnLeg {
  double move = 0, hold = 0;  // s
  Vector3d translation = Vector3d::Zero(), rotation_deg = Vector3d::Zero();
};

/// One world; its random numbers are of a stream of its own.
class World {
 public:
  /// least: s, of the motion of the kind none.
  World(const DiscrepancyObject& object, const DiscrepancyKind& kind, double least,
        math::Random random)
      : object_(object),
        kind_(kind),
        random_(random),
        plant_(scenes::read_scene(config::Node::load_file(object.scene.string())).plant) {
    world_.kind = kind.name;
    world_.object = object.name;
    world_.scene = object.scene;
    world_.configuration = object.configuration;
    for (int i = 0; i < kLegs; ++i) legs_.push_back(random_leg());
    if (kind.name != "none") return;
    double duration = 0;
    for (const DrawnLeg& leg : legs_) duration += leg.move + leg.hold;
    for (; duration < least; duration += legs_.back().move + legs_.back().hold)
      legs_.push_back(random_leg());
  }

  /// After the model error, whose place of the clamp a shifted clamp moves.
  DiscrepancyWorld make(const std::vector<std::string>& daemon) {
    const std::string& kind = kind_.name;
    if (kind == "table" || kind == "wall" || kind == "cylinder") obstacle(kind);
    if (kind == "sprung clamp") sprung_clamp();
    if (kind == "shifted clamp") shifted_clamp(daemon);
    if (kind == "stiffer half") stiffer_half();
    move();
    if (kind == "slip") slip();
    if (kind == "weight") weight();
    return world_;
  }

 private:
  double drawn(const std::string& parameter, const char* unit, double value) {
    world_.drawn.push_back({parameter, unit, value});
    return value;
  }
  double drawn(const std::string& parameter, const char* unit, const DrawnRange& range) {
    return drawn(parameter, unit, range.draw(random_));
  }
  double sign() { return random_.below(2) == 0 ? -1 : 1; }

  void set(const std::string& key, const std::string& value) {
    world_.scene_overrides.push_back(key + "=" + value);
  }

  Vector3d within(const Vector3d& most) {
    Vector3d v;
    for (int axis = 0; axis < 3; ++axis) v[axis] = random_.uniform(-most[axis], most[axis]);
    return v;
  }

  DrawnLeg random_leg() {
    return {kMove.draw(random_), kHold.draw(random_), within(object_.translation),
            within(object_.rotation_deg)};
  }

  /// Free motion, two poses against the obstacle, and away from it again.
  void press(const Vector3d& towards, double clearance, double depth) {
    for (std::size_t i = 0; i < legs_.size(); ++i) {
      Vector3d& translation = legs_[i].translation;
      const double along = translation.dot(towards);
      translation -= along * towards;
      if (i == 1 || i == 2)
        translation = 0.5 * translation + (clearance + (i == 1 ? 0.7 : 1) * depth) * towards;
      else
        translation -= std::abs(along) * towards;
    }
  }

  void obstacle(const std::string& kind) {
    const Vector3d& size = plant_.size;
    // An upright plate stands on a table, but nothing lies under its edge.
    const bool is_upright = size.z() > 2 * size.y();
    const bool is_below =
        kind == "table" || (kind == "cylinder" && !is_upright && random_.below(2) == 0);
    const double clearance = drawn("clearance", "m", kind_.clearance);
    const double depth = drawn("depth", "m", is_below ? object_.down : object_.side);
    const double friction = drawn("friction", "", kind_.friction);
    const double side = is_below ? -1 : drawn("side", "", sign());
    const int axis = is_below ? 2 : 1;
    const Vector3d towards = side * Vector3d::Unit(axis);
    RigidObstacle body;
    body.point = 0.5 * size;
    body.point[axis] = side < 0 ? -clearance : size[axis] + clearance;
    std::string text;
    if (kind == "cylinder") {
      body.radius = drawn("radius", "m", kind_.radius);
      body.point.x() = drawn("place", "", kind_.place) * size.x();
      body.point += body.radius * towards;
      body.direction = Vector3d::Unit(is_below ? 1 : 2);
      text = "{cylinder: {point: " + text_of(body.point) + ", axis: " + text_of(body.direction) +
             ", radius: " + text_of(body.radius) + "}";
    } else {
      body.direction = -towards;
      text =
          "{plane: {point: " + text_of(body.point) + ", normal: " + text_of(body.direction) + "}";
    }
    set("obstacles", "[" + text + ", friction: " + text_of(friction) + "}]");
    world_.obstacle = body;
    press(towards, clearance, depth);
  }

  void sprung_clamp() {
    const auto& [least, most] = object_.clamp_stiffness;
    const double stiffness =
        drawn("clamp stiffness", "N/m", least * std::pow(most / least, random_.uniform()));
    set("object.clamp_pads",
        "{stiffness: " + text_of(stiffness) + ", damping: " + text_of(kPadDamping) + "}");
  }

  /// The clamp is elsewhere than palpated knows, the hand where it is reported: palpated's object
  /// moves the other way.
  void shifted_clamp(const std::vector<std::string>& daemon) {
    const double shift = drawn("shift", "m", kind_.shift),
                 angle = drawn("direction", "deg", random_.uniform(0, 360)) * math::kDegree;
    const math::Pose X_WO =
        registry::read_frames(config::Node::load_file(world_.configuration.string(), daemon)).X_WO;
    const Vector3d moved = X_WO * (shift * Vector3d(0, std::cos(angle), std::sin(angle)));
    world_.daemon_overrides.push_back("frames.object_in_base.position=" + text_of(moved));
  }

  void stiffer_half() {
    const bool is_far = drawn("side", "", sign()) > 0;
    const double middle = 0.5 * plant_.size.x();
    set("object.material.regions",
        "[{box: {lower: " + text_of(Vector3d(is_far ? middle : -kBeyond, -kBeyond, -kBeyond)) +
            ", upper: " + text_of(Vector3d(is_far ? kBeyond : middle, kBeyond, kBeyond)) +
            "}, factor: " + text_of(kind_.factor) + "}]");
  }

  void move() {
    world_.begin = kDelay;
    world_.duration = kDelay + kAfterLast;
    std::string text;
    for (const DrawnLeg& leg : legs_) {
      text += (text.empty() ? "" : ", ") + std::string("{move: ") + text_of(leg.move) +
              ", hold: " + text_of(leg.hold) + ", translation: " + text_of(leg.translation) +
              ", rotation_deg: " + text_of(leg.rotation_deg) + "}";
      world_.duration += leg.move + leg.hold;
    }
    set("motion", "{start_delay: " + text_of(kDelay) + ", poses: [" + text + "]}");
  }

  /// During the middle of the motion, with time before and after it.
  void begin(double duration) {
    world_.onset = drawn("onset", "s", random_.uniform(0.3, 0.5) * world_.duration);
    world_.end = std::min(world_.onset + duration, world_.duration - 2);
  }

  void slip() {
    begin(drawn("duration", "s", kind_.duration));
    const object::Box& patch = plant_.grasps.at(0).patch;
    const double length = drawn("slip", "m", sign() * kind_.part * (patch.upper - patch.lower).x());
    set("slips", "[{at: " + text_of(world_.onset) +
                     ", duration: " + text_of(world_.end - world_.onset) +
                     ", hand: 0, translation: " + text_of(Vector3d(length, 0, 0)) + "}]");
    world_.end = std::numeric_limits<double>::infinity();  // the hand holds another place since
  }

  void weight() {
    begin(drawn("duration", "s", kind_.duration));
    const double force = drawn("weight", "N", object_.weight);
    // A little below the top, which a drawn dimension may lower.
    const Vector3d point(drawn("place", "", kind_.place) * plant_.size.x(), 0.5 * plant_.size.y(),
                         0.9 * plant_.size.z());
    set("pokes",
        "[{at: " + text_of(world_.onset) + ", duration: " + text_of(world_.end - world_.onset) +
            ", point: " + text_of(point) + ", force: " + text_of(Vector3d(0, 0, -force)) + "}]");
  }

  const DiscrepancyObject& object_;
  const DiscrepancyKind& kind_;
  math::Random random_;
  const object::PlantOptions plant_;
  std::vector<DrawnLeg> legs_;
  DiscrepancyWorld world_;
};

/// Kinds in turn by their shares, so that few worlds hold many kinds: each next world is of the
/// kind that is furthest behind its share. All of one kind if that is given.
std::vector<const DiscrepancyKind*> kinds_of(const DiscrepancyPlan& plan, const std::string& only,
                                             int count) {
  if (!only.empty()) {
    const auto found = std::find_if(plan.kinds.begin(), plan.kinds.end(),
                                    [&only](const auto& kind) { return kind.name == only; });
    if (found == plan.kinds.end())
      throw std::invalid_argument("no kind is called \"" + only + "\"");
    return {static_cast<std::size_t>(count), &*found};
  }
  int all = 0;
  for (const DiscrepancyKind& kind : plan.kinds) all += kind.share;
  std::vector<int> done(plan.kinds.size(), 0);
  std::vector<const DiscrepancyKind*> kinds;
  for (int i = 0; i < count; ++i) {
    std::size_t next = 0;
    double most = -HUGE_VAL;
    for (std::size_t k = 0; k < plan.kinds.size(); ++k) {
      if (plan.kinds[k].share == 0) continue;
      const double share = static_cast<double>(plan.kinds[k].share) / all;
      const double behind = share * (i + 1) - done[k];
      if (behind > most) next = k;
      most = std::max(most, behind);
    }
    ++done[next];
    kinds.push_back(&plan.kinds[next]);
  }
  return kinds;
}

void append(std::vector<std::string>& to, const std::vector<std::string>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

}  // namespace

double RigidObstacle::distance(const Vector3d& p) const {
  if (radius == 0) return direction.dot(p - point);
  return (p - point).cross(direction).norm() - radius;
}

std::vector<DiscrepancyWorld> make_worlds(const DiscrepancyPlan& plan,
                                          const WorldSelection& selection, const fs::path& root) {
  const auto& [set, count, seed, errors, kind, minutes] = selection;
  const auto objects = plan.sets.find(set);
  if (objects == plan.sets.end()) throw std::invalid_argument("no set is called \"" + set + "\"");
  const std::string distribution = errors.empty() ? plan.errors : errors;
  std::optional<uncertainty::Distributions> distributions;
  if (distribution != "none")
    distributions =
        uncertainty::read_distributions(uncertainty::distributions_file(root, distribution));
  // Sets differ in the numbers of their model errors as well.
  const math::Random of_set =
      math::Random(static_cast<std::uint64_t>(seed), "discrepancies " + set);
  const uncertainty::LatinHypercube sample(math::Random(of_set).next(), count);

  std::vector<DiscrepancyWorld> worlds;
  const std::vector<const DiscrepancyKind*> kinds = kinds_of(plan, kind, count);
  for (int i = 0; i < count; ++i) {
    math::Random random = of_set.split("world " + std::to_string(i + 1));
    const std::string& name = objects->second[random.below(objects->second.size())];
    const DiscrepancyObject& object =
        *std::find_if(plan.objects.begin(), plan.objects.end(),
                      [&name](const auto& known) { return known.name == name; });
    runs::Mismatch error;
    if (distributions)
      error = uncertainty::draw_mismatch(*distributions, sample, i + 1, object.scene,
                                         object.configuration);
    World maker(object, *kinds[static_cast<std::size_t>(i)], 60 * minutes, random);
    DiscrepancyWorld world = maker.make(error.daemon);
    std::vector<std::string> daemon = error.daemon;
    append(daemon, world.daemon_overrides);
    append(daemon, plan.method.overrides);
    world.daemon_overrides = std::move(daemon);
    append(error.scene, world.scene_overrides);
    world.scene_overrides = std::move(error.scene);
    world.scene_overrides.push_back("seed=" + std::to_string(random.below(1000000000)));
    world.drawn.insert(world.drawn.end(), error.drawn.begin(), error.drawn.end());
    world.name = common::file_name(set + " " + std::to_string(seed) + " " + std::to_string(i + 1) +
                                   " " + world.kind + " " + world.object);
    worlds.push_back(std::move(world));
  }
  return worlds;
}

}  // namespace palpate::studies
