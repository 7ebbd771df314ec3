#include "tools/collect/localise.hpp"

#include <algorithm>
#include <cmath>
#include <ostream>

#include "tools/collect/protocol.hpp"
#include "tools/common/table.hpp"
#include "tools/recordings/csv_reader.hpp"

namespace palpate::collect {
namespace {

using Eigen::Vector3d;
using sensing::ElectrodeScatter;
using sensing::ElectrodeVector;
using sensing::kElectrodeCount;

constexpr double kLeastForce = 0.5;  // N
constexpr std::uint64_t kSeed = 1;

struct Variant {
  const char* name;
  ElectrodeScatter scatter;
};
constexpr Variant kVariants[] = {{"nominal", ElectrodeScatter::kNominal},
                                 {"gaussian", ElectrodeScatter::kGaussian},
                                 {"inverted", ElectrodeScatter::kInvertedGaussian}};

struct Sums {
  std::vector<double> distances;
  Vector3d mean = Vector3d::Zero(), absolute = Vector3d::Zero();
  long right = 0;
};

}  // namespace

std::vector<LocalisationErrors> score_localisation(const std::filesystem::path& file,
                                                   const sensing::LocalizationOptions& options,
                                                   double least_force) {
  recordings::CsvReader csv(file.string());
  const int trial = csv.column("trial"), area = csv.column("area"), time = csv.column("t");
  const int force[] = {csv.column("fx"), csv.column("fy"), csv.column("fz")};
  int electrode[kElectrodeCount];
  for (int i = 0; i < kElectrodeCount; ++i) electrode[i] = csv.column("e" + std::to_string(i + 1));

  Sums sums[std::size(kVariants)];
  math::Random random(kSeed);
  std::string current;
  ElectrodeVector rest = ElectrodeVector::Zero();
  int rest_rows = 0;
  while (csv.next()) {
    if (csv.text(trial) != current) {
      current = csv.text(trial);
      rest.setZero();
      rest_rows = 0;
    }
    ElectrodeVector counts;
    for (int i = 0; i < kElectrodeCount; ++i) counts[i] = csv.number(electrode[i]);
    if (csv.number(time) <= kRest) {
      rest += counts;
      ++rest_rows;
      continue;
    }
    if (rest_rows == 0) csv.fail("a trial without rest before it");
    const Vector3d pressed(csv.number(force[0]), csv.number(force[1]), csv.number(force[2]));
    if (pressed.norm() <= least_force) continue;
    counts -= rest / rest_rows;
    const double number = csv.number(area);
    if (number < 1 || number > sensing::kAreaCount || number != std::floor(number))
      csv.fail(area, "must be a whole number from 1 to 9");
    const int right_area = static_cast<int>(number);
    const Vector3d place = sensing::project_on_skin(sensing::area_centres().col(right_area - 1));
    for (std::size_t v = 0; v < std::size(kVariants); ++v) {
      const sensing::Localization found = sensing::locate_contact(
          counts, options,
          sensing::scatter_electrodes(counts, options, kVariants[v].scatter, random));
      if (found.active == 0) continue;
      const Vector3d error = found.location - place;
      sums[v].mean += error;
      sums[v].absolute += error.cwiseAbs();
      sums[v].distances.push_back(error.norm());
      sums[v].right += sensing::nearest_area(found.location) == right_area;
    }
  }
  std::vector<LocalisationErrors> list;
  for (std::size_t v = 0; v < std::size(kVariants); ++v) {
    Sums& sum = sums[v];
    LocalisationErrors errors;
    errors.variant = kVariants[v].name;
    errors.samples = static_cast<long>(sum.distances.size());
    if (errors.samples > 0) {
      const double n = static_cast<double>(errors.samples);
      errors.mean = sum.mean / n;
      errors.absolute = sum.absolute / n;
      errors.area_rate = static_cast<double>(sum.right) / n;
      const auto middle = sum.distances.begin() + errors.samples / 2;
      std::nth_element(sum.distances.begin(), middle, sum.distances.end());
      errors.median = *middle;
    }
    list.push_back(errors);
  }
  return list;
}

void run_localise(const std::filesystem::path& file, const sensing::LocalizationOptions& options,
                  std::ostream& out) {
  using common::number;
  common::Table rows({"variant", "weighting", "samples", "X mean mm", "|X|", "Y mean mm", "|Y|",
                      "Z mean mm", "|Z|", "median mm", "right area %"});
  for (const auto weighting : {sensing::Weighting::kPublished, sensing::Weighting::kCentroid}) {
    sensing::LocalizationOptions with = options;
    with.weighting = weighting;
    for (const LocalisationErrors& e : score_localisation(file, with, kLeastForce)) {
      std::vector<std::string> cells{
          e.variant, weighting == sensing::Weighting::kPublished ? "published" : "centroid",
          std::to_string(e.samples)};
      for (int i = 0; i < 3; ++i) {
        cells.push_back(number(1e3 * e.mean[i], 2));
        cells.push_back(number(1e3 * e.absolute[i], 2));
      }
      cells.push_back(number(1e3 * e.median, 2));
      cells.push_back(number(100 * e.area_rate, 1));
      rows.add(cells);
    }
  }
  rows.print(out);
}

}  // namespace palpate::collect
