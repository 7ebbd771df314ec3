#include "tools/mesh/faults.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "core/mesh/near_nodes.hpp"

namespace palpate::mesh_tool {

void add_size_fault(const Eigen::Matrix3Xd& points, std::vector<Fault>& faults) {
  // Sizes that a hand can hold, with a wide margin.
  constexpr double kLargest = 3, kSmallest = 3e-3;  // m
  const double size = mesh::diagonal(points);
  if (!(size > kLargest) && !(size < kSmallest)) return;
  Fault fault;
  fault.kind = "units";
  fault.severity = Severity::kWarning;
  std::ostringstream out;
  out.precision(3);
  out << "the body is " << size << " m across: are its lengths in "
      << (size > kLargest ? "mm? then --scale 0.001" : "other units? see --scale");
  fault.text = out.str();
  faults.push_back(fault);
}

bool has_errors(const std::vector<Fault>& faults) {
  return std::any_of(faults.begin(), faults.end(),
                     [](const Fault& f) { return f.severity == Severity::kError; });
}

std::string list_numbers(const std::vector<long>& numbers) {
  constexpr std::size_t kShown = 20;
  std::string list;
  for (std::size_t i = 0; i < std::min(kShown, numbers.size()); ++i) {
    list += (i > 0 ? ", " : "") + (numbers[i] < 0 ? "new" : std::to_string(numbers[i]));
  }
  return list + (numbers.size() > kShown ? ", ..." : "");
}

std::string text(const std::vector<Fault>& faults) {
  std::ostringstream out;
  for (const Fault& fault : faults) {
    out << (fault.severity == Severity::kError ? "error: " : "warning: ");
    out << fault.text;
    if (!fault.numbers.empty())
      out << ": " << fault.numbers.size() << " (" << list_numbers(fault.numbers) << ')';
    out << '\n';
  }
  return out.str();
}

nlohmann::json to_json(const std::vector<Fault>& faults) {
  nlohmann::json list = nlohmann::json::array();
  for (const Fault& fault : faults) {
    nlohmann::json points = nlohmann::json::array();
    for (const Eigen::Vector3d& p : fault.points) {
      if (p.allFinite()) points.push_back({p.x(), p.y(), p.z()});
    }
    list.push_back({{"kind", fault.kind},
                    {"severity", fault.severity == Severity::kError ? "error" : "warning"},
                    {"text", fault.text},
                    {"numbers", fault.numbers},
                    {"places", points}});
  }
  return list;
}

}  // namespace palpate::mesh_tool
