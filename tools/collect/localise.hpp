#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

#include "core/sensing/electrode_scatter.hpp"

namespace palpate::collect {

/// Errors of the classical localisation in the probe protocol of the thesis (Fig. 3.13).
struct LocalisationErrors {
  std::string variant;
  long samples = 0;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();      // m, along x, y, z of T
  Eigen::Vector3d absolute = Eigen::Vector3d::Zero();  // m, mean of the absolute value
  double median = 0;                                   // m, of the distance
  double area_rate = 0;  // fraction of samples assigned to the correct area
};

/// For each kind of scatter, over the samples of a CSV collection whose force exceeds `least_force`
/// (N; thesis: 0.5). The true location is the centre of the trial's area on the skin; counts are
/// tared by the rest before each trial. Throws import::CsvError.
std::vector<LocalisationErrors> score_localisation(const std::filesystem::path& file,
                                                   const sensing::LocalizationOptions& options,
                                                   double least_force);

void run_localise(const std::filesystem::path& file, const sensing::LocalizationOptions& options,
                  std::ostream& out);

}  // namespace palpate::collect
