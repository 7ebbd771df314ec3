#include "sim/object/graded_borders.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>

namespace palpate::object {
namespace {

constexpr double kSame = 1e-9;  // m

/// Number of elements that fit into `distance` from a plane if the first is `first` m long and
/// their length grows by `slope` m per metre, i.e. by a factor exp(slope) from one to the next; and
/// the inverse.
double elements_within(double distance, double first, double slope) {
  return slope > 0 ? std::log1p(slope * distance / first) / slope : distance / first;
}
double distance_after(double elements, double first, double slope) {
  return slope > 0 ? first / slope * std::expm1(slope * elements) : elements * first;
}

/// A section between two cuts; element lengths grow from the ends that are planes.
struct Section {
  double lower, upper;
  bool from_lower, from_upper;

  double reach() const { return (upper - lower) / (from_lower && from_upper ? 2 : 1); }
  double elements(double first, double slope) const {
    return (from_lower && from_upper ? 2 : 1) * elements_within(reach(), first, slope);
  }

  /// The border after the fraction `s` of its elements.
  double border(double s, double first, double slope) const {
    const double all = elements(first, slope);
    if (from_lower && (!from_upper || s < 0.5))
      return lower + distance_after(s * all, first, slope);
    return upper - distance_after((1 - s) * all, first, slope);
  }
};

double elements(const std::vector<Section>& sections, double first, double slope) {
  double sum = 0;
  for (const Section& section : sections) sum += section.elements(first, slope);
  return sum;
}

/// Element length at the planes for which `count` elements fill all sections.
double first_length(const std::vector<Section>& sections, double length, int count, double slope) {
  double least = 1e-9 * length, most = length;
  for (int i = 0; i < 200; ++i) {
    const double middle = std::sqrt(least * most);
    (elements(sections, middle, slope) > count ? least : most) = middle;
  }
  return most;
}

/// Integers, at least one per section, that sum to `count`: each further element goes to the
/// section with the largest deficit.
std::vector<int> share_out(const std::vector<Section>& sections, int count, double first,
                           double slope) {
  std::vector<int> counts(sections.size(), 1);
  for (int left = count - static_cast<int>(sections.size()); left > 0; --left) {
    std::size_t neediest = 0;
    double most = -std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < sections.size(); ++i) {
      const double lack = sections[i].elements(first, slope) - counts[i];
      if (lack > most) neediest = i;
      most = std::max(most, lack);
    }
    ++counts[neediest];
  }
  return counts;
}

}  // namespace

std::vector<double> graded_borders(double length, int count, std::vector<double> planes,
                                   double growth) {
  if (!(length > 0)) {
    throw std::invalid_argument("plant: every side of the box must be positive");
  }
  if (count < 1) throw std::invalid_argument("plant: at least one element per axis");
  if (!(growth >= 1)) throw std::invalid_argument("plant: grading must be at least 1");
  std::sort(planes.begin(), planes.end());
  std::vector<Section> sections{{0, length, false, false}};
  for (const double plane : planes) {
    if (growth == 1) break;
    Section& last = sections.back();
    if (plane < last.lower + kSame) {
      last.from_lower = true;
    } else if (plane > length - kSame) {
      last.from_upper = true;
    } else {
      last.upper = plane;
      last.from_upper = true;
      sections.push_back({plane, length, true, false});
    }
  }
  if (count < static_cast<int>(sections.size())) {
    throw std::invalid_argument("plant: fewer elements than stretches between clamp and grasp");
  }
  const bool any = sections.front().from_lower || sections.back().from_upper || sections.size() > 1;
  const double slope = any ? std::log(growth) : 0;
  const double first = first_length(sections, length, count, slope);
  const std::vector<int> counts = share_out(sections, count, first, slope);
  std::vector<double> borders{0};
  for (std::size_t i = 0; i < sections.size(); ++i) {
    const Section& section = sections[i];
    for (int k = 1; k < counts[i]; ++k)
      borders.push_back(section.border(static_cast<double>(k) / counts[i], first, slope));
    borders.push_back(section.upper);
  }
  return borders;
}

std::vector<double> planes_of(const Box& hold, const Eigen::Vector3d& origin,
                              const Eigen::Vector3d& size, int axis) {
  const double lower = hold.lower[axis] - origin[axis], upper = hold.upper[axis] - origin[axis];
  std::vector<double> planes;
  for (const double plane : {lower, upper}) {
    if (plane > kSame && plane < size[axis] - kSame) planes.push_back(plane);
  }
  const bool flat = upper - lower < kSame && planes.empty();
  if (flat && std::abs(lower) < kSame) planes.push_back(0);
  if (flat && std::abs(upper - size[axis]) < kSame) planes.push_back(size[axis]);
  return planes;
}

std::vector<std::string> misfits(const Box& hold, const Eigen::Vector3d& origin,
                                 const std::array<std::vector<double>, 3>& borders, bool midnodes) {
  std::vector<std::string> sentences;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> planes = borders[axis];
    for (std::size_t i = 0; midnodes && i + 1 < borders[axis].size(); ++i)
      planes.push_back(0.5 * (borders[axis][i] + borders[axis][i + 1]));
    for (const bool upper : {false, true}) {
      const double face = (upper ? hold.upper : hold.lower)[axis] - origin[axis];
      if (face < kSame || face > borders[axis].back() - kSame) continue;
      // The last plane within the box.
      double held = upper ? 0 : borders[axis].back();
      for (const double plane : planes) {
        if (upper && plane < face + kSame) held = std::max(held, plane);
        if (!upper && plane > face - kSame) held = std::min(held, plane);
      }
      if (std::abs(held - face) < kSame) continue;
      std::ostringstream text;
      text << (upper ? "ends" : "begins") << " at "
           << "xyz"[axis] << " = " << face + origin[axis] << " m between nodes and holds "
           << (upper ? "up to " : "from ") << held + origin[axis]
           << " m instead: choose other elements, or grading > 1";
      sentences.push_back(text.str());
    }
  }
  return sentences;
}

}  // namespace palpate::object
