#include "tools/fit/experiments/uniaxial_data.hpp"

#include <cmath>
#include <cstdio>

#include "core/math/constants.hpp"
#include "tools/fit/experiments/video.hpp"
#include "tools/fit/recording.hpp"

namespace palpate::fit {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

using math::kPi;
constexpr Index kLeastRows = 4;

const config::Key kGeometry("geometry", "", "of the specimen");

/// Rest area from the geometry.
double read_area(const config::Node& geometry) {
  const config::Range size{1e-6, 100};
  const auto area =
      optional_quantity(geometry, {"area", "", "of the section"}, Dimension::kArea, {1e-12, 1e4});
  const auto length = [&](const config::Key& key) {
    return optional_quantity(geometry, key, Dimension::kLength, size);
  };
  const auto diameter = length({"diameter", "", "of the section, where there is no area"});
  const auto width = length({"width", "", "of the section, where there is neither of them"});
  const auto thickness = length({"thickness", "", "of the section, in addition to its width"});
  if (area) return *area;
  if (diameter) return kPi / 4 * *diameter * *diameter;
  if (!width || !thickness)
    geometry.fail("area", "is absent; give area, diameter, or width and thickness of the bar");
  return *width * *thickness;
}

/// Strain in the direction of the test.
VectorXd read_strain(const config::Node& node, const Recording& recording, UniaxialData& data) {
  if (recording.has("strain")) return recording.column("strain");
  if (recording.has("stretch")) {
    const VectorXd strain = recording.column("stretch").array() - 1;
    return data.is_compression ? VectorXd(-strain) : strain;
  }
  const config::Node geometry = node.child_or_empty(kGeometry);
  const auto length = optional_quantity(geometry, {"length", "", "at rest; absent: the first gap"},
                                        Dimension::kLength, {1e-6, 100});
  if (recording.has("gap")) {
    const VectorXd& gap = recording.column("gap");
    data.length = length.value_or(gap[0]);
    const double sign = data.is_compression ? -1 : 1;
    return sign * (gap.array() - gap[0]) / data.length;
  }
  if (!length) geometry.fail("length", "is absent; a displacement needs it");
  data.length = *length;
  return recording.column("displacement") / data.length;
}

void check(const Recording& recording, const UniaxialData& data) {
  const char* const load = data.is_stress ? "stress" : "force";
  if (data.time.size() > 0) recording.require_rising("time");
  Index least = 0, most = 0;
  const double low = data.strain.minCoeff(&least), high = data.strain.maxCoeff(&most);
  if (!(high > low))
    recording.fail(0, "strain is the same in every row: nothing can be learnt from it");
  if (!(data.load.maxCoeff() > data.load.minCoeff()))
    recording.fail(0,
                   std::string(load) + " is the same in every row: nothing can be learnt from it");
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
  for (std::size_t k = 0; k < rows.size(); ++k) result[k] = values[rows[k]];
  return result;
}

/// Keeps these rows.
void keep(const std::vector<Index>& rows, UniaxialData& data) {
  data.strain = taken(data.strain, rows);
  data.load = taken(data.load, rows);
  if (data.time.size() > 0) data.time = taken(data.time, rows);
  if (data.width.size() > 0) data.width = taken(data.width, rows);
}

/// Leaves the rows of the time window.
void cut(const config::Node& node, const Recording& recording, UniaxialData& data) {
  if (!node.has("window")) return;
  const config::Node window = node.child({"window", "", "of time that is looked at"});
  const double from =
      optional_quantity(window, {"from", "", "its start"}, Dimension::kTime, {}).value_or(-1e300);
  const double to =
      optional_quantity(window, {"to", "", "its end"}, Dimension::kTime, {}).value_or(1e300);
  if (data.time.size() == 0) node.fail("window", "needs a column `time`");
  std::vector<Index> rows;
  for (Index i = 0; i < data.time.size(); ++i)
    if (data.time[i] >= from && data.time[i] <= to) rows.push_back(i);
  if (static_cast<Index>(rows.size()) < kLeastRows)
    recording.fail("fewer than 4 samples within `window`");
  keep(rows, data);
}

/// Keeps every n-th row of data sampled faster than they change.
void thin(const config::Node& node, UniaxialData& data) {
  const int every = node.integer({"every", "", "each so-and-so-many-th row"}, {1, 1000}, 1);
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

/// Replaces cycles by their mean curve, or marks the first of them as not used.
void treat_cycles(const config::Node& node, const Recording& recording, UniaxialData& data) {
  data.is_used.assign(static_cast<std::size_t>(data.strain.size()), true);
  if (!node.has("cycles")) return;
  const config::Node cycles = node.child({"cycles", "", "of loading and unloading"});
  const int skip = cycles.integer({"skip", "", "of the first"}, {0, 1000}, 0);
  const Index first = after_cycles(data.strain, skip);
  if (first + kLeastRows > data.strain.size())
    recording.fail("has no more than " + std::to_string(skip) + " cycles; lower cycles.skip");
  if (cycles.flag({"average", "", "only their mean curve counts"}, false)) {
    const int points = cycles.integer({"points", "", "of the mean curve"}, {4, 10000}, 101);
    const MeanCurve curve = mean_curve(data.strain, data.load, skip, points);
    if (curve.cycles == 0) recording.fail("no whole cycle is left; lower cycles.skip");
    const bool is_zeroed = cycles.flag({"zero", "", "the mean curve's load begins at 0"}, false);
    data.load = is_zeroed ? VectorXd(curve.value.array() - curve.value[0]) : curve.value;
    if (data.width.size() > 0) data.width = mean_curve(data.strain, data.width, skip, points).value;
    data.strain = curve.strain;
    data.time.resize(0);
    data.is_used.assign(static_cast<std::size_t>(points), true);
    return;
  }
  for (Index i = 0; i < first; ++i) data.is_used[i] = false;
}

}  // namespace

UniaxialData read_uniaxial(const config::Node& node, const std::filesystem::path& folder) {
  UniaxialData data;
  const config::Node columns =
      node.child({"columns", "", "where each quantity stands in the file"});
  data.is_stress = columns.has("stress");
  std::vector<WantedColumn> wanted = {
      {"time", Dimension::kTime, "of the sample", false},
      {"strain", Dimension::kStrain, "in the direction of the test", false},
      {"stretch", Dimension::kRatio, "instead: length by length at rest", false},
      {"gap", Dimension::kLength, "instead: between plates or clamps", false},
      {"width", Dimension::kLength, "across", false}};
  const bool has_strain = columns.has("strain") || columns.has("stretch") || columns.has("gap");
  if (!has_strain)
    wanted.push_back({"displacement", Dimension::kLength, "where neither of these is there"});
  wanted.push_back(data.is_stress
                       ? WantedColumn{"stress", Dimension::kStress, "instead: nominal"}
                       : WantedColumn{"force", Dimension::kForce, "in the test's direction"});
  const Recording recording(node, folder, wanted);
  recording.require_rows(kLeastRows);

  data.name = recording.name();
  data.is_compression = node.choice({"direction", "", "of the test"}, {"tension", "compression"},
                                    "tension") == "compression";
  data.strain = read_strain(node, recording, data);
  data.load = recording.column(data.is_stress ? "stress" : "force");
  if (!data.is_stress) data.area = read_area(node.child(kGeometry));
  if (recording.has("time")) data.time = recording.column("time");
  if (recording.has("width")) data.width = recording.column("width");
  check(recording, data);
  cut(node, recording, data);
  if (node.has("video"))
    data.width = aligned_widths(
        node.child({"video", "", "a recording of the width; its clock is put by the peaks"}),
        folder, data);
  thin(node, data);
  treat_cycles(node, recording, data);

  const NamedValues named = {{"strain", data.strain}, {"load", data.load}};
  const Selection use =
      read_selection(node, {"use", "", "samples that count: true, or {quantity, from, to}"}, true);
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
    seen += data.is_used[i] && std::isfinite(data.width[i]) ? 1 : 0;
  if (data.width.size() > 0 && seen < kLeastRows)
    recording.fail("the video saw fewer than 4 of the samples; check its clock, or leave it out");
  const double range = data.load.maxCoeff() - data.load.minCoeff();
  data.load_deviation =
      optional_quantity(node, {"deviation", "", "of the load; absent: a hundredth of its range"},
                        data.is_stress ? Dimension::kStress : Dimension::kForce, {1e-12, 1e12})
          .value_or(0.01 * range);
  if (data.width.size() > 0)
    data.width_deviation =
        optional_quantity(node, {"width_deviation", "", "absent: a thousandth of the greatest"},
                          Dimension::kLength, {1e-12, 1})
            .value_or(1e-3 * greatest_width(data));
  return data;
}

}  // namespace palpate::fit
