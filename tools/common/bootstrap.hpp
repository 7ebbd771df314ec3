#pragma once

#include <string>
#include <vector>

namespace palpate::common {

/// A figure with the interval that holds it with 95 %.
struct Interval95 {
  double value = 0;
  double low = 0;
  double high = 0;
};

/// Median (of an even number the mean of the two in the middle) and its percentile bootstrap
/// interval (Efron and Tibshirani 1993, chapter 13): 2000 resamples from a fixed seed, so that the
/// same values always give the same. `values` must not be empty.
Interval95 median_of(std::vector<double> values);

/// Share of successes and Wilson's score interval (1927), which holds at 0 and 1 too, where a
/// bootstrap would know nothing. `trials` at least 1.
Interval95 share_of(int successes, int trials);

/// "1.20 (1.10 to 1.40)", of one value alone "1.20", of none "not available".
std::string median_and_interval(const std::vector<double>& values, int decimals);

/// "95 % (85 to 99)", or "not available" of no trials.
std::string share_and_interval(int successes, int trials);

}  // namespace palpate::common
