#include "tools/fit/uniaxial_data.hpp"

#include <cmath>
#include <cstdio>

#include "tools/fit/cycles.hpp"
#include "tools/fit/held_out.hpp"
#include "tools/fit/recording.hpp"
#include "tools/fit/video.hpp"

namespace palpate::fit {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double kPi = 3.14159265358979323846;
constexpr Index kLeastRows = 4;

/// Rest area from what the geometry gives.
double read_area(const config::Node& geometry) {
  const config::Range size{1e-6, 100};
  if (geometry.has("area")) return read_quantity(geometry, "area", Dimension::kArea, {1e-12, 1e4});
  if (geometry.has("diameter")) {
    const double d = read_quantity(geometry, "diameter", Dimension::kLength, size);
    return kPi / 4 * d * d;
  }
  if (!geometry.has("width") || !geometry.has("thickness"))
    geometry.fail("area", "is absent; give area, diameter, or width and thickness of the bar");
  return read_quantity(geometry, "width", Dimension::kLength, size) *
         read_quantity(geometry, "thickness", Dimension::kLength, size);
}

/// Strain in the direction of the test.
VectorXd read_strain(const config::Node& node, const Recording& recording, UniaxialData& data) {
  if (recording.has("strain")) return recording.column("strain");
  if (recording.has("stretch")) {
    const VectorXd strain = recording.column("stretch").array() - 1;
    return data.is_compression ? VectorXd(-strain) : strain;
  }
  const config::Node geometry = node.child_or_empty("geometry");
  const config::Range size{1e-6, 100};
  if (recording.has("gap")) {
    const VectorXd& gap = recording.column("gap");
    data.length = read_quantity(geometry, "length", Dimension::kLength, size, gap[0]);
    const double sign = data.is_compression ? -1 : 1;
    return sign * (gap.array() - gap[0]) / data.length;
  }
  data.length = read_quantity(geometry, "length", Dimension::kLength, size);
  return recording.column("displacement") / data.length;
}

void check(const Recording& recording, const UniaxialData& data) {
  const char* const load = data.is_stress ? "stress" : "force";
  if (data.time.size() > 0) recording.require_rising("time");
  Index least = 0, most = 0;
  const double low = data.strain.minCoeff(&least), high = data.strain.maxCoeff(&most);
  if (!(high > low)) recording.fail(0, "strain is the same in every row: nothing can be told");
  if (!(data.load.maxCoeff() > data.load.minCoeff()))
    recording.fail(0, std::string(load) + " is the same in every row: nothing can be told");
  const std::string way = data.is_compression ? "compression" : "tension";
  if (std::abs(low) > std::abs(high))
    recording.fail(least, "strain goes further against `direction: " + way +
                              "` than along it; give the column `sign: -1` or the other direction");
  const VectorXd centred = data.strain.array() - data.strain.mean();
  if (!(centred.dot(data.load) > 0))
    recording.fail(most, std::string(load) +
                             " falls as the bar is strained, so that its sign must "
                             "be wrong; it is positive in " +
                             way + ": give its column `sign: -1`");
  const Index bad = [&] {
    for (Index i = 0; i < data.strain.size(); ++i)
      if (data.is_compression ? data.strain[i] >= 1 : data.strain[i] <= -1) return i;
    return Index(-1);
  }();
  if (bad >= 0)
    recording.fail(bad, "the bar would have no length left; check units and geometry.length");
  if (data.time.size() > 0) return;
  double reached = low;
  for (Index i = 0; i < data.strain.size(); ++i) {
    if (reached - data.strain[i] > 0.01 * (high - low))
      recording.fail(i,
                     "strain comes back; a recording that is not one pull needs a column "
                     "`time`, or `rows` for the part to take");
    reached = std::max(reached, data.strain[i]);
  }
}

template <class Values>
Values taken(const Values& values, const std::vector<Index>& rows) {
  Values result(rows.size());
  for (std::size_t k = 0; k < rows.size(); ++k) result[static_cast<Index>(k)] = values[rows[k]];
  return result;
}

/// Leaves these rows.
void keep(const std::vector<Index>& rows, UniaxialData& data) {
  data.strain = taken(data.strain, rows);
  data.load = taken(data.load, rows);
  if (data.time.size() > 0) data.time = taken(data.time, rows);
  if (data.width.size() > 0) data.width = taken(data.width, rows);
}

/// Leaves the rows of the time window.
void cut(const config::Node& node, const Recording& recording, UniaxialData& data) {
  if (!node.has("window")) return;
  const config::Node window = node.child("window");
  const double from = read_quantity(window, "from", Dimension::kTime, {}, -1e300);
  const double to = read_quantity(window, "to", Dimension::kTime, {}, 1e300);
  if (data.time.size() == 0) node.fail("window", "needs a column `time`");
  std::vector<Index> rows;
  for (Index i = 0; i < data.time.size(); ++i)
    if (data.time[i] >= from && data.time[i] <= to) rows.push_back(i);
  if (static_cast<Index>(rows.size()) < kLeastRows)
    recording.fail("fewer than 4 samples within `window`");
  keep(rows, data);
}

/// Leaves every n-th row, of what was recorded faster than it changes.
void thin(const config::Node& node, UniaxialData& data) {
  const int every = node.integer("every", {1, 1000}, 1);
  if (every == 1) return;
  std::vector<Index> rows;
  for (Index i = 0; i < data.strain.size(); i += every) rows.push_back(i);
  keep(rows, data);
}

double greatest_width(const UniaxialData& data) {
  double greatest = 0;
  for (const double width : data.width)
    if (width > greatest) greatest = width;
  return greatest;
}

/// Cycles to their mean curve, or the first of them marked as not used.
void treat_cycles(const config::Node& node, const Recording& recording, UniaxialData& data) {
  data.is_used.assign(static_cast<std::size_t>(data.strain.size()), true);
  if (!node.has("cycles")) return;
  const config::Node cycles = node.child("cycles");
  const int skip = cycles.integer("skip", {0, 1000}, 0);
  const Index first = after_cycles(data.strain, skip);
  if (first + kLeastRows > data.strain.size())
    recording.fail("has no more than " + std::to_string(skip) + " cycles; lower cycles.skip");
  if (cycles.flag("average", false)) {
    const int points = cycles.integer("points", {4, 10000}, 101);
    const MeanCurve curve = mean_curve(data.strain, data.load, skip, points);
    if (curve.cycles == 0) recording.fail("no whole cycle is left; lower cycles.skip");
    data.load =
        cycles.flag("zero", false) ? VectorXd(curve.value.array() - curve.value[0]) : curve.value;
    if (data.width.size() > 0) data.width = mean_curve(data.strain, data.width, skip, points).value;
    data.strain = curve.strain;
    data.time.resize(0);
    data.is_used.assign(static_cast<std::size_t>(points), true);
    return;
  }
  for (Index i = 0; i < first; ++i) data.is_used[static_cast<std::size_t>(i)] = false;
}

}  // namespace

UniaxialData read_uniaxial(const config::Node& node, const std::filesystem::path& folder) {
  UniaxialData data;
  const config::Node columns = node.child("columns");
  data.is_stress = columns.has("stress");
  std::vector<WantedColumn> wanted = {{"time", Dimension::kTime, false},
                                      {"strain", Dimension::kStrain, false},
                                      {"stretch", Dimension::kRatio, false},
                                      {"gap", Dimension::kLength, false},
                                      {"width", Dimension::kLength, false}};
  const bool has_strain = columns.has("strain") || columns.has("stretch") || columns.has("gap");
  if (!has_strain) wanted.push_back({"displacement", Dimension::kLength});
  wanted.push_back(data.is_stress ? WantedColumn{"stress", Dimension::kStress}
                                  : WantedColumn{"force", Dimension::kForce});
  const Recording recording(node, folder, wanted);
  recording.require_rows(kLeastRows);

  data.name = recording.name();
  data.is_compression =
      node.choice("direction", {"tension", "compression"}, "tension") == "compression";
  data.strain = read_strain(node, recording, data);
  data.load = recording.column(data.is_stress ? "stress" : "force");
  if (!data.is_stress) data.area = read_area(node.child("geometry"));
  if (recording.has("time")) data.time = recording.column("time");
  if (recording.has("width")) data.width = recording.column("width");
  check(recording, data);
  cut(node, recording, data);
  if (node.has("video")) data.width = aligned_widths(node.child("video"), folder, data);
  thin(node, data);
  treat_cycles(node, recording, data);

  const NamedValues named = {{"strain", data.strain}, {"load", data.load}};
  const Selection use = read_selection(node, "use", true);
  const std::vector<bool> selected = selected_samples(use, node, "use", recording, named);
  Index used = 0;
  for (std::size_t i = 0; i < data.is_used.size(); ++i) {
    data.is_used[i] = data.is_used[i] && (selected.empty() || selected[i]);
    used += data.is_used[i] ? 1 : 0;
  }
  if (used < kLeastRows)
    recording.fail("only " + std::to_string(used) +
                   " samples are left by `use` and `cycles`; 4 "
                   "are needed");
  data.is_held_out = held_out_samples(node, recording, named);
  if (data.is_held_out.empty()) data.is_held_out.assign(data.is_used.size(), false);
  Index seen = 0;
  for (Index i = 0; i < data.width.size(); ++i)
    seen += data.is_used[static_cast<std::size_t>(i)] && std::isfinite(data.width[i]) ? 1 : 0;
  if (data.width.size() > 0 && seen < kLeastRows)
    recording.fail("the video saw fewer than 4 of the samples; check its clock, or leave it out");
  const double range = data.load.maxCoeff() - data.load.minCoeff();
  data.load_deviation =
      read_quantity(node, "deviation", data.is_stress ? Dimension::kStress : Dimension::kForce,
                    {1e-12, 1e12}, 0.01 * range);
  if (data.width.size() > 0)
    data.width_deviation = read_quantity(node, "width_deviation", Dimension::kLength, {1e-12, 1},
                                         1e-3 * greatest_width(data));
  return data;
}

}  // namespace palpate::fit
