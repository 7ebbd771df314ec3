#include "tools/fit/held/held_decay.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace palpate::fit {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

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

constexpr double kArm = 0.1;  // m, at which torques are weighted like forces

/// One mode at one time: its two waves, and their derivatives by d and by omega at constant d.
struct Waves {
  double c, s, c_d, s_d, c_omega, s_omega;

  Waves(double t, double d, double omega) {
    const double w = std::sqrt(omega * omega - d * d), fade = std::exp(-d * t);
    c = fade * std::cos(w * t);
    s = fade * std::sin(w * t);
    const double c_w = -t * s, s_w = t * c;
    c_d = -t * c - c_w * d / w;
    s_d = -t * s - s_w * d / w;
    c_omega = c_w * omega / w;
    s_omega = s_w * omega / w;
  }
};

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

HeldDecay::HeldDecay(std::string name, const HeldCell& cell, std::vector<HeldRinging> ringings,
                     const HeldDecayOptions& options)
    : Experiment(std::move(name)),
      ringings_(std::move(ringings)),
      options_(options),
      young_(cell.object.body.material.young_modulus),
      density_(cell.object.body.material.density) {
  if (ringings_.empty()) throw std::invalid_argument(name_ + ": the hand never stops");
  find_patterns(cell);
  list_series(cell);
  list_parameters(cell);
  scan();
}

void HeldDecay::find_patterns(const HeldCell& cell) {
  const elasticity::Body& body = cell.object.body;
  elasticity::StaticSolver solver(body);
  const Eigen::Matrix3Xd no_loads = Eigen::Matrix3Xd::Zero(3, body.mesh.node_count());
  const math::Pose X_SG = cell.frames.X_ES.inverse() * cell.frames.X_EG;
  for (const HeldRinging& ringing : ringings_) {
    const math::Pose X_OG = cell.frames.X_WO.inverse() * ringing.X_WE * cell.frames.X_EG;
    const auto found = solver.solve(no_loads, {X_OG, {}});
    if (!found.converged)
      throw std::invalid_argument(name_ + ": no equilibrium is found for the hand at " +
                                  std::to_string(ringing.time) + " s");
    const HeldModes modes = find_modes(body, X_OG, found.positions, options_.modes);
    Stop stop;
    stop.frequencies = modes.frequencies;
    stop.begin = modes.stops;
    stop.sizes.resize(options_.modes);
    stop.patterns.resize(6, options_.modes);
    const Eigen::Matrix3d R_SO =
        (ringing.X_WE * cell.frames.X_ES).linear().transpose() * cell.frames.X_WO.linear();
    for (int i = 0; i < options_.modes; ++i) {
      const Eigen::Vector3d force = R_SO * modes.wrenches.col(i).head<3>();
      const Eigen::Vector3d torque =
          R_SO * modes.wrenches.col(i).tail<3>() + X_SG.translation().cross(force);
      stop.patterns.col(i) << force, torque;
      stop.sizes[i] = std::hypot(force.norm(), torque.norm() / kArm);
      stop.patterns.col(i) /= stop.sizes[i];
    }
    stops_.push_back(stop);
  }
}

void HeldDecay::list_series(const HeldCell& cell) {
  Eigen::Index row = 0;
  for (std::size_t j = 0; j < ringings_.size(); ++j) {
    const HeldRinging& ringing = ringings_[j];
    stops_[j].first_row = row;
    row += 6 * ringing.times.size();
    for (int k = 0; k < 6; ++k)
      series_.push_back({std::string(k < 3 ? "force " : "torque ") + "xyz"[k % 3] + " after stop " +
                             std::to_string(j + 1),
                         k < 3 ? "N" : "N m",
                         "time",
                         "s",
                         ringing.times,
                         cell.polarity * ringing.readings.row(k).transpose(),
                         std::max(ringing.deviation[k], k < 3 ? kFinestForce : kFinestTorque),
                         {}});
  }
}

void HeldDecay::list_parameters(const HeldCell& cell) {
  const elasticity::Damping& damping = cell.object.body.damping;
  const auto add = [this](const std::string& name, const char* unit, double start, double lower,
                          double upper, bool is_sought, bool is_logarithmic) {
    parameters_.push_back(
        {name, unit, start, is_sought ? lower : start, is_sought ? upper : start, is_logarithmic});
  };
  add("young_modulus", "Pa", young_, 10, 1e9, true, true);
  add("density", "kg/m^3", density_, 0.5, 2e4, options_.density, true);
  add("mass_damping", "1/s", damping.mass_factor, 0, 1e3, options_.mass_damping, false);
  add("stiffness_damping", "s", damping.stiffness_factor, 0, 1, options_.stiffness_damping, false);
  for (std::size_t j = 0; j < stops_.size(); ++j) {
    stops_[j].first_parameter = static_cast<int>(parameters_.size());
    const std::string stop = name_ + ".stop" + std::to_string(j + 1);
    for (int i = 0; i < options_.modes; ++i) {
      const std::string mode = stop + "_mode" + std::to_string(i + 1);
      add(mode + "_cos", "N", 0, -100, 100, true, false);
      add(mode + "_sin", "N", 0, -100, 100, true, false);
    }
    for (int k = 0; k < 6; ++k)
      add(stop + "_rest_" + kWrench[k], k < 3 ? "N" : "N m", 0, k < 3 ? -500 : -50,
          k < 3 ? 500 : 50, true, false);
  }
}

/// Amplitudes and rest values are linear: their optimum, and the remaining sum of squares.
double HeldDecay::fit_amplitudes(VectorXd& parameters) const {
  VectorXd prediction;
  MatrixXd jacobian;
  if (!predict(parameters, prediction, &jacobian)) return 1e300;
  double left = 0;
  for (std::size_t j = 0; j < stops_.size(); ++j) {
    const Eigen::Index n = ringings_[j].times.size(), row = stops_[j].first_row;
    const int first = stops_[j].first_parameter, count = 2 * options_.modes + 6;
    MatrixXd A = jacobian.block(row, first, 6 * n, count);
    VectorXd b(6 * n);
    for (int k = 0; k < 6; ++k) {
      const Series& series = series_[6 * j + k];
      A.middleRows(k * n, n) /= series.deviation;
      b.segment(k * n, n) = series.measured / series.deviation;
    }
    // Modes that the wrench cannot distinguish share the amplitude.
    MatrixXd normal = A.transpose() * A;
    normal.diagonal().array() += 1e-10 * normal.diagonal().maxCoeff();
    const VectorXd best = normal.ldlt().solve(A.transpose() * b);
    parameters.segment(first, count) = best;
    left += (A * best - b).squaredNorm();
  }
  return left;
}

/// Between two frequencies a wave that is off by one cycle fits better than those in between, so
/// that a search must start near the correct one.
void HeldDecay::scan() {
  const auto is_silent = [](const HeldRinging& ringing) { return ringing.readings.isZero(0); };
  if (std::all_of(ringings_.begin(), ringings_.end(), is_silent)) return;
  VectorXd best = start();
  double least = 1e301;
  const double slowest = stops_[0].frequencies[0];
  for (double factor = 0.3; factor < 3.3; factor *= 1.02) {
    for (double ratio : {0.01, 0.03, 0.1}) {
      VectorXd p = start();
      p[kYoungModulus] *= factor;
      const double decay = 2 * ratio * slowest * std::sqrt(factor);
      if (options_.mass_damping) {
        p[kMass] = decay;
      } else if (options_.stiffness_damping) {
        p[kStiffness] = decay / (slowest * slowest * factor);
      }
      const double left = fit_amplitudes(p);
      if (left < least) {
        least = left;
        best = p;
      }
    }
  }
  if (least > 1e299)
    throw std::invalid_argument(
        name_ + ": with the configuration's object.damping nothing would ring, but creep back");
  for (std::size_t k = 0; k < parameters_.size(); ++k) parameters_[k].start = best[k];
}

/// With q = 0 and q' at the stop, P (q + stiffness_damping q').
VectorXd HeldDecay::after_stop(VectorXd p, int index, const math::Vector6d& twist) const {
  const Stop& stop = stops_[index];
  const double share = std::sqrt(p[kYoungModulus] / young_ * density_ / p[kObjectDensity]);
  for (int i = 0; i < options_.modes; ++i) {
    const double omega = share * stop.frequencies[i];
    const double d = 0.5 * (p[kMass] + p[kStiffness] * omega * omega);
    const double speed = stop.sizes[i] * stop.begin.row(i) * twist;
    const double w = std::sqrt(omega * omega - d * d);
    p[stop.first_parameter + 2 * i] = p[kStiffness] * speed;
    p[stop.first_parameter + 2 * i + 1] = (1 - p[kStiffness] * d) * speed / w;
  }
  return p;
}

bool HeldDecay::predict(const VectorXd& p, VectorXd& prediction, MatrixXd* jacobian) const {
  prediction.setZero(sample_count());
  if (jacobian) jacobian->setZero(sample_count(), p.size());
  const double share = std::sqrt(p[kYoungModulus] / young_ * density_ / p[kObjectDensity]);
  for (std::size_t j = 0; j < stops_.size(); ++j) {
    const Stop& stop = stops_[j];
    const VectorXd& times = ringings_[j].times;
    const Eigen::Index n = times.size();
    const int rest = stop.first_parameter + 2 * options_.modes;
    for (int k = 0; k < 6; ++k) {
      prediction.segment(stop.first_row + k * n, n).setConstant(p[rest + k]);
      if (jacobian) jacobian->block(stop.first_row + k * n, rest + k, n, 1).setOnes();
    }
    for (int i = 0; i < options_.modes; ++i) {
      const double omega = share * stop.frequencies[i];
      const double d = 0.5 * (p[kMass] + p[kStiffness] * omega * omega);
      if (!(d < omega)) return false;
      const int place = stop.first_parameter + 2 * i;
      const double a = p[place], b = p[place + 1];
      for (Eigen::Index t = 0; t < n; ++t) {
        const Waves wave(times[t], d, omega);
        const double by_d = a * wave.c_d + b * wave.s_d;
        const double by_omega = a * wave.c_omega + b * wave.s_omega + by_d * p[kStiffness] * omega;
        for (int k = 0; k < 6; ++k) {
          const Eigen::Index row = stop.first_row + k * n + t;
          const double pattern = stop.patterns(k, i);
          prediction[row] += pattern * (a * wave.c + b * wave.s);
          if (!jacobian) continue;
          (*jacobian)(row, place) += pattern * wave.c;
          (*jacobian)(row, place + 1) += pattern * wave.s;
          (*jacobian)(row, kYoungModulus) += pattern * by_omega * 0.5 * omega / p[kYoungModulus];
          (*jacobian)(row, kObjectDensity) -= pattern * by_omega * 0.5 * omega / p[kObjectDensity];
          (*jacobian)(row, kMass) += pattern * by_d * 0.5;
          (*jacobian)(row, kStiffness) += pattern * by_d * 0.5 * omega * omega;
        }
      }
    }
  }
  return true;
}

}  // namespace palpate::fit
