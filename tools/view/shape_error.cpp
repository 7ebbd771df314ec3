#include "tools/view/shape_error.hpp"

#include <cmath>
#include <cstdlib>
#include <exception>

namespace palpate::view {
namespace {

constexpr std::size_t kMostShapes = 64;
constexpr std::int64_t kSameClock = 300'000;  // us, largest difference
// Of nodes and elements, which are searched once in the thread that serves the pages.
constexpr double kLargestSearch = 1e8;

}  // namespace

void ShapeError::set_meshes(const shape_mesh_t& mesh, const shape_mesh_t& truth_mesh) {
  if (hash_ == mesh.mesh_hash && truth_hash_ == truth_mesh.mesh_hash) return;
  hash_ = mesh.mesh_hash;
  truth_hash_ = truth_mesh.mesh_hash;
  points_.reset();
  waiting_.clear();
  before_.reset();
  after_.reset();
  last_.reset();
  const log::MeshMessage plant = log::mesh_of(truth_mesh);
  if (plant.elements.cols() == 0 ||
      static_cast<double>(plant.elements.cols()) * mesh.node_count > kLargestSearch)
    return;
  try {
    points_.emplace(plant, log::mesh_of(mesh).nodes);
  } catch (const std::exception&) {
    // Of other elements, or of a body that is none: not comparable.
  }
}

void ShapeError::take(const shape_mesh_t& mesh, const shape_t& shape,
                      const shape_mesh_t& truth_mesh, const shape_t& truth) {
  set_meshes(mesh, truth_mesh);
  if (!points_ || shape.node_count != mesh.node_count || truth.node_count != truth_mesh.node_count)
    return;
  if (waiting_.empty() || waiting_.back().utime != shape.utime) {
    waiting_.push_back({shape.session, shape.utime, log::positions(shape)});
    if (waiting_.size() > kMostShapes) waiting_.pop_front();
  }
  if (after_ && after_->session == truth.session && after_->utime == truth.utime) return;
  const bool continues = after_ && after_->session == truth.session && after_->utime < truth.utime;
  before_.reset();
  if (continues) {
    before_ = std::move(after_);
  } else {
    last_.reset();
    waiting_.erase(waiting_.begin(), waiting_.end() - 1);
  }
  after_ = Moment{truth.session, truth.utime, points_->at(log::positions(truth))};
  if (!before_) return;
  // A simulator slower than real time has a separate clock.
  if (std::abs(waiting_.back().utime - after_->utime) > kSameClock) {
    compare(waiting_.back(), 1);
    if (last_) last_->by_arrival = true;
    waiting_.erase(waiting_.begin(), waiting_.end() - 1);
    return;
  }
  const double interval = static_cast<double>(after_->utime - before_->utime);
  const Moment* newest = nullptr;
  for (const Moment& one : waiting_)
    if (one.utime >= before_->utime && one.utime <= after_->utime) newest = &one;
  if (newest) compare(*newest, static_cast<double>(newest->utime - before_->utime) / interval);
  while (waiting_.size() > 1 && waiting_.front().utime <= after_->utime) waiting_.pop_front();
}

/// With the truth at this fraction between the last two.
void ShapeError::compare(const Moment& shape, double part) {
  const Eigen::VectorXd distance =
      (shape.nodes - (1 - part) * before_->nodes - part * after_->nodes).colwise().norm();
  if (!distance.allFinite()) return;
  last_ = Distances{distance.mean(),
                    std::sqrt(distance.squaredNorm() / static_cast<double>(distance.size())),
                    distance.maxCoeff(), false};
}

}  // namespace palpate::view
