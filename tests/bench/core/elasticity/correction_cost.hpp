#pragma once

#include <functional>

#include "core/elasticity/corotational_model.hpp"
#include "tests/bench/core/elasticity/candidate_elements.hpp"

namespace palpate::bench {

/// Parts of a correction in the loop: one pass over the elements and one solve. Thread time, s,
/// median of many after the caches have warmed up.
double time_element_pass(const elasticity::Body& body, const Eigen::Matrix3Xd& x,
                         elasticity::Precision precision = elasticity::SolverOptions().precision);
double time_curved_pass(const elasticity::Body& body, const Eigen::Matrix3Xd& x);

struct SolveCost {
  long entries = 0;       // scalars of the panels
  std::size_t bytes = 0;  // that they take
  double seconds = 0;     // of one solve
};

/// Of the loop's panels for a stiffness over `stencils` (with the pattern of the candidate's
/// tangent at rest), in the loop's own elimination order. Fixed nodes and held patches count as in
/// the loop.
SolveCost time_solve(const elasticity::Body& body, Volumetric volumetric,
                     factor::PanelPrecision precision = elasticity::SolverOptions().panels);

/// Median thread time of `run`, s; repeats it for a few hundredths of a second.
double median_time(const std::function<void()>& run);

}  // namespace palpate::bench
