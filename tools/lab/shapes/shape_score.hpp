#pragma once

#include <Eigen/Core>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

namespace palpate::shapes {

inline constexpr double kMm = 1e-3;  // m, unit of recordings and scores

/// Difference of one predicted quantity from the recorded one.
struct ShapeScore {
  std::string quantity;
  std::string unit;
  double error = 0;            // of a signed quantity: predicted minus measured
  double deviation = 0;        // standard deviation of the recording; 0: not stated
  std::optional<double> goal;  // largest permitted absolute error
  bool is_fitted = false;      // a parameter was fitted to this quantity: it shows nothing

  bool met() const;  // also without a goal
};

/// A line of the page's picture, mm.
struct ShapeOutline {
  std::string name;
  Eigen::Matrix2Xd points;
  bool is_measured = false;
  bool is_line = true;  // false: separate points
};

/// One recorded shape, predicted with one model.
struct ShapeResult {
  std::string recording;  // "folder/case"
  std::string model;      // law and mesh
  std::string material;   // each modulus, with its origin
  int nodes = 0;
  std::optional<double> incremental_deviation;  // m, of the loop's incremental model
  std::vector<ShapeScore> scores;
  std::vector<ShapeOutline> outlines;
  std::vector<std::string> notes;

  bool met() const;
};

void print_shapes(const std::vector<ShapeResult>& results, std::ostream& out);

/// Units as in the scores; outlines in mm.
nlohmann::json to_json(const ShapeResult& result);

}  // namespace palpate::shapes
