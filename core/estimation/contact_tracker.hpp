#pragma once

#include "core/estimation/contact_detector.hpp"
#include "core/estimation/contact_search.hpp"
#include "core/estimation/wrench_update.hpp"

namespace palpate::estimation {

/// Locates and follows one unmodelled external contact while the hands rest. Computes the changes
/// of their wrenches and the values that ContactDetector judges, searches the surface for the
/// location of the contact, and adds or removes its force in the fused state. Its force acts on the
/// object and is expressed in O. Nothing allocates after construction.
class ContactTracker {
 public:
  struct Options : ContactDetector::Options {
    ContactSearch::Options search;
    bool contacts = true;  // whether external contacts are searched for
  };

  ContactTracker(const elasticity::Body& body, const mesh::Surface& surface, const Options& options,
                 const WrenchSampling& sampling);

  void reset() noexcept;
  /// The hands have moved: drops contact and suspicions, and begins a new baseline.
  void restart(FusedState& state, WrenchUpdate& wrenches,
               const elasticity::DeformationModel& model) noexcept;

  /// Judges an innovation without contact. True if an external contact is suspected, so that the
  /// innovation must not correct other states.
  bool detect(const Innovation& now, FusedState& state, WrenchUpdate& wrenches) noexcept;
  /// Judges an innovation with a contact and corrects its force.
  void track(const Innovation& now, FusedState& state, WrenchUpdate& wrenches) noexcept;
  /// Call once per tick: evaluates some candidates of a search, and drops a contact that has ended.
  void advance(double dt, FusedState& state, WrenchUpdate& wrenches,
               const elasticity::DeformationModel& model) noexcept;

  const ContactDetector& detector() const noexcept { return detector_; }
  /// The contact once it is confirmed.
  UnknownContact estimate(const WrenchFilter& filter,
                          const elasticity::DeformationModel& model) const noexcept;

 private:
  void judge_search(FusedState& state, WrenchUpdate& wrenches,
                    const elasticity::DeformationModel& model) noexcept;
  void place(const ContactSearch::Found& found, FusedState& state, WrenchUpdate& wrenches,
             const elasticity::DeformationModel& model) noexcept;
  void drop(FusedState& state, WrenchUpdate& wrenches,
            const elasticity::DeformationModel& model) noexcept;
  bool may_be_setting_off(const FusedState& state) const noexcept;
  void add_change(const WrenchFilter::Wrenches& change) noexcept;
  void begin_search(const RestBaseline& baseline, const std::array<bool, 2>& held) noexcept;

  Options options_;
  WrenchSampling sampling_;
  ContactDetector detector_;
  ContactSearch search_;
  std::array<Eigen::Vector3d, 2> outward_G_;  // unit vectors from the object to the hands
  int place_ = -1;                            // candidate index of the contact
  double place_deviation_ = 0;                // m, standard deviation of its location
  /// Mean change of the wrenches since it began, including those caused by the contact.
  WrenchFilter::Wrenches change_;
  int change_count_ = 0;
};

}  // namespace palpate::estimation
