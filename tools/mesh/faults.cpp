#include "tools/mesh/fault_finder.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "core/mesh/near_nodes.hpp"

namespace palpate::mesh_tool {

namespace {

constexpr int kFaces[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};  // of a tetrahedron

}  // namespace

Fault& FaultFinder::start(const std::string& kind, const std::string& what, Severity severity) {
  Fault& fault = faults_.emplace_back();
  fault.kind = kind;
  fault.text = what;
  fault.severity = severity;
  return fault;
}

void FaultFinder::add_cells(const std::string& kind, const std::string& what,
                            const std::vector<int>& cells, Severity severity) {
  if (cells.empty()) return;
  Fault& fault = start(kind, what, severity);
  for (const int cell : cells) {
    fault.numbers.push_back(cell_number_(cell));
    show(cell, fault);
  }
}

void FaultFinder::add_points(const std::string& kind, const std::string& what,
                             const std::vector<int>& points) {
  if (points.empty()) return;
  Fault& fault = start(kind, what);
  for (const int n : points) {
    fault.numbers.push_back(point_number_(n));
    if (points_.col(n).allFinite()) fault.points.emplace_back(points_.col(n));
  }
}

void FaultFinder::show_edges(const std::vector<mesh::Edge>& edges, Fault& fault) const {
  for (const auto& [a, b] : edges) {
    fault.lines.emplace_back(points_.col(a), points_.col(b));
    fault.points.emplace_back(0.5 * (points_.col(a) + points_.col(b)));
  }
}

void FaultFinder::show(int cell, Fault& fault) const {
  std::vector<int> corners;
  for (const int n : cells_.col(cell)) {
    if (n >= 0 && n < points_.cols() && points_.col(n).allFinite()) corners.push_back(n);
  }
  if (corners.empty()) return;
  const Eigen::Matrix3Xd x = points_(Eigen::all, corners);
  fault.points.emplace_back(x.rowwise().mean());
  if (x.cols() == 4) {
    for (const auto& face : kFaces) fault.faces.emplace_back(x(Eigen::all, face));
  }
  if (x.cols() == 3) fault.faces.push_back(x);
  if (x.cols() == 2) fault.lines.emplace_back(x.col(0), x.col(1));
}

std::vector<int> FaultFinder::cells_at(const std::vector<int>& points) const {
  std::vector<int> found;
  for (int cell = 0; cell < cells_.cols(); ++cell) {
    const auto corners = cells_.col(cell);
    if (std::any_of(corners.begin(), corners.end(), [&points](int n) {
          return std::binary_search(points.begin(), points.end(), n);
        }))
      found.push_back(cell);
  }
  return found;
}

void FaultFinder::add_size() {
  // Sizes that a hand can hold, with a wide margin.
  constexpr double kLargest = 3, kSmallest = 3e-3;  // m
  const double size = mesh::diagonal(points_);
  if (!(size > kLargest) && !(size < kSmallest)) return;
  std::ostringstream out;
  out.precision(3);
  out << "the body is " << size << " m across: are its lengths in "
      << (size > kLargest ? "mm? then --scale 0.001" : "other units? see --scale");
  start("units", out.str(), Severity::kWarning);
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
