#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "tools/fit/held/held_decay.hpp"

namespace palpate::fit {
namespace {

/// Noise of one message: second differences are insensitive to slow oscillations.
math::Vector6d message_deviation(const std::vector<ft_wrench_t>& wrenches, std::size_t begin,
                                 std::size_t end) {
  math::Vector6d squares = math::Vector6d::Zero();
  const auto at = [&](std::size_t i) {
    return Eigen::Map<const math::Vector6d>(wrenches[i].wrench);
  };
  for (std::size_t i = begin + 1; i + 1 < end; ++i)
    squares += (at(i - 1) - 2 * at(i) + at(i + 1)).cwiseAbs2();
  return (squares / (6.0 * static_cast<double>(end - begin - 2))).cwiseSqrt();
}

/// Means over 1 / rate s of the messages from `begin` us on.
bool read_ringing(const HeldLog& log, std::int64_t begin, double duration, double rate,
                  HeldRinging& ringing) {
  const std::vector<ft_wrench_t>& all = log.wrenches;
  const auto place = [&](std::int64_t utime) {
    return static_cast<std::size_t>(
        std::lower_bound(all.begin(), all.end(), utime,
                         [](const ft_wrench_t& w, std::int64_t t) { return w.utime < t; }) -
        all.begin());
  };
  const std::size_t first = place(begin),
                    last = place(begin + static_cast<std::int64_t>(1e6 * duration));
  const auto bins = static_cast<Eigen::Index>(std::lround(duration * rate));
  if (last < first + static_cast<std::size_t>(bins) + 3) return false;
  ringing.times.setZero(bins);
  ringing.readings.setZero(6, bins);
  Eigen::VectorXi counts = Eigen::VectorXi::Zero(bins);
  for (std::size_t i = first; i < last; ++i) {
    const double time = 1e-6 * static_cast<double>(all[i].utime - begin);
    const auto bin = std::min(static_cast<Eigen::Index>(time * rate), bins - 1);
    ringing.times[bin] += time;
    ringing.readings.col(bin) += Eigen::Map<const math::Vector6d>(all[i].wrench);
    ++counts[bin];
  }
  if (counts.minCoeff() == 0) return false;
  ringing.times.array() /= counts.cast<double>().array();
  ringing.readings.array().rowwise() /= counts.cast<double>().array().transpose();
  ringing.deviation = message_deviation(all, first, last) / std::sqrt(counts.cast<double>().mean());
  return true;
}

}  // namespace

std::vector<HeldRinging> read_ringings(const std::string& log, const CalmRule& rule,
                                       const std::string& time, double duration, double rate) {
  const HeldLog messages = read_held_log(log, rule, time);
  const std::vector<HeldBlock>& blocks = messages.blocks;
  const int needed = static_cast<int>(std::ceil(duration / kBlock));
  std::vector<HeldRinging> ringings;
  bool has_moved = false;
  for (int i = 0; i + needed <= static_cast<int>(blocks.size()); ++i) {
    const auto is_calm = [](const HeldBlock& block) { return block.calm; };
    if (i > 0 && blocks[i].whole && !blocks[i].calm) has_moved = true;
    if (!has_moved || !std::all_of(blocks.begin() + i, blocks.begin() + i + needed, is_calm))
      continue;
    has_moved = false;
    HeldRinging ringing;
    ringing.time = kBlock * i;
    PoseMean pose;
    for (int k = 0; k < needed; ++k) pose.add(blocks[i + k].X_WE);
    ringing.X_WE = pose.get();
    const std::int64_t begin = messages.begin + static_cast<std::int64_t>(1e6 * ringing.time);
    if (read_ringing(messages, begin, duration, rate, ringing))
      ringings.push_back(std::move(ringing));
  }
  if (ringings.empty())
    throw std::runtime_error(log + ": the hand never stops and stays calm for " +
                             std::to_string(duration) +
                             " s with a message in each step; stop sooner, or take a lower rate");
  return ringings;
}

}  // namespace palpate::fit
