#pragma once

#include <string>
#include <vector>

namespace palpate::common {

/// A value with its 95 % confidence interval.
struct Interval95 {
  double value = 0;
  double low = 0;
  double high = 0;
};

/// Median (for an even number the mean of the middle two) and its percentile bootstrap interval
/// (Efron and Tibshirani 1993, chapter 13): 2000 resamples from a fixed seed, so that the result is
/// deterministic. `values` must not be empty.
Interval95 median_of(std::vector<double> values);

/// Proportion of successes and Wilson's score interval (1927), which is valid at 0 and 1 too, where
/// a bootstrap is not. `trials` at least 1.
Interval95 share_of(int successes, int trials);

/// "1.20 (1.10 to 1.40)", for one value "1.20", for none "not available".
std::string median_and_interval(const std::vector<double>& values, int decimals);

/// "95 % (85 to 99)", or "not available" for no trials.
std::string share_and_interval(int successes, int trials);

}  // namespace palpate::common
