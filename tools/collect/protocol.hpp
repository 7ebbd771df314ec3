#pragma once

#include <string>
#include <vector>

namespace palpate::collect {

enum class ProbeShape { kFlat, kSphere, kConcave };

struct Probe {
  std::string name;
  ProbeShape shape = ProbeShape::kFlat;
  double radius = 0;  // m: of the flat's edge, the sphere or the hollow
};

/// Load of a trial: the force held, and its tangential component.
struct ForceProfile {
  std::string name;
  double force = 0;   // N, along the normal
  double shear = 0;   // relative to the force
  double wander = 0;  // relative to the force: amplitude of its variation while held
};

/// One press of the protocol of the thesis (section 3.2): approach, 3 s of hold, 1 s of release.
struct Trial {
  int number = 0;  // from 0; with the seed it determines all randomness
  Probe probe;
  int area = 1;  // 1 to 9
  ForceProfile profile;
  int repeat = 0;
};

inline constexpr double kRest = 0.5, kApproach = 0.3, kHold = 3,
                        kRelease = 1;  // s, duration of a trial
inline constexpr double kTrialTime = kRest + kApproach + kHold + kRelease;

enum class Profiles {
  kThesis,    // 0.2, 0.3 and 0.4 N, perpendicular
  kExtended,  // these, and three of up to 2 N with variation and shear
};

/// Flat and spherical probes of 3, 5 and 7.5 mm and a concave one.
const std::vector<Probe>& probes();

/// Every probe on every area with every profile, five times each: 945 trials of kThesis, 1890 of
/// kExtended.
std::vector<Trial> make_trials(Profiles profiles);

/// "flat_3 area 4 0.2N 1", readable.
std::string name_of(const Trial& trial);

/// Force relative to the held one at `t` s of a trial, without variation.
double envelope(double t);

/// Radius (m) of the contact area of a probe pressed on a fingertip with `force` (N): the bodies'
/// paraboloids on an elastic foundation (Johnson 1985, section 4.3), at most the probe's own edge.
/// `foundation`: N/m^3.
double contact_radius(const Probe& probe, double force, double foundation);

}  // namespace palpate::collect
