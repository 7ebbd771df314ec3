#include "core/math/quadratic_program.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace palpate::math {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// A unit normal depends on the active ones if its part outside them is shorter than this.
constexpr double kDependent = 1e-11;
/// The same for a row of the last optimum, which is found again if it is omitted here.
constexpr double kDependentAtStart = 1e-7;
/// A multiplier that changes by less along a unit step counts as constant.
constexpr double kUnchanged = 1e-13;
/// Bounds that cross by less, relative to their size, count as equal.
constexpr double kEqual = 1e-12;
constexpr double kPrices[] = {kInfinity, 1e6, 1e4, 1e2};  // by level

}  // namespace

QuadraticProgram::QuadraticProgram(int variables) {
  if (variables < 1 || variables > kMostVariables) {
    throw std::invalid_argument("a quadratic program has 1 to " + std::to_string(kMostVariables) +
                                " variables, not " + std::to_string(variables));
  }
  H.setZero(variables, variables);
  g.setZero(variables);
  A.setZero(variables, kMostRows);
}

double QuadraticProgramSolver::Row::least() const noexcept {
  return at_upper && lower != upper ? 0 : -price;
}

double QuadraticProgramSolver::Row::greatest() const noexcept {
  return at_upper || lower == upper ? price : 0;
}

QuadraticProgramSolver::Status QuadraticProgramSolver::solve(const QuadraticProgram& program,
                                                             Start start) noexcept {
  n_ = program.variables();
  m_ = program.rows();
  iterations_ = 0;
  u_.setZero(n_);
  multipliers_.setZero(m_);
  violations_.setZero(m_);
  const bool warm = start == Start::kWarm && last_variables_ == n_ && last_rows_ == m_;
  last_variables_ = n_;
  last_rows_ = -1;  // until this program has been solved
  if (!is_valid(program)) return Status::kNotFinite;
  if (!scale(program)) return Status::kNotConvex;
  if (!set_bounds(program)) return Status::kInfeasible;
  price(program);

  Status status = Status::kIterationLimit;
  if (warm) {
    take_active_rows();
    status = iterate();
  }
  if (!warm || status == Status::kIterationLimit) {
    iterations_ = 0;
    for (int i = 0; i < m_; ++i) release(row_[i]);
    factor_.clear(n_);
    project();
    status = iterate();
  }
  publish(program);
  if (status == Status::kOptimal) last_rows_ = m_;
  return status;
}

bool QuadraticProgramSolver::is_valid(const QuadraticProgram& program) const noexcept {
  if (!program.g.allFinite() || !program.A.leftCols(m_).allFinite()) return false;
  for (int k = 0; k < n_; ++k) {
    if (!program.H.col(k).tail(n_ - k).allFinite()) return false;
  }
  return std::all_of(program.bounds.begin(), program.bounds.begin() + m_,
                     [](const QuadraticProgram::Bounds& bounds) {
                       const RowPriority& priority = bounds.priority;
                       return bounds.lower < kInfinity && bounds.upper > -kInfinity &&
                              priority.level >= 0 && priority.level <= RowPriority::kSoftest &&
                              priority.weight > 0 && std::isfinite(priority.weight);
                     });
}

/// Computes L, y0 and the unit normals.
bool QuadraticProgramSolver::scale(const QuadraticProgram& program) noexcept {
  const Eigen::LLT<ColumnFactor::Matrix> cholesky(program.H);
  if (cholesky.info() != Eigen::Success) return false;
  L_ = cholesky.matrixLLT();
  y0_ = -program.g;
  L_.triangularView<Eigen::Lower>().solveInPlace(y0_);

  N_.resize(n_, QuadraticProgram::kMostRows);
  values_.setZero(m_);
  for (int k = 0; k < n_; ++k) {
    auto row = N_.row(k).head(m_);
    row = program.A.row(k).head(m_);
    for (int j = 0; j < k; ++j) row -= L_(k, j) * N_.row(j).head(m_);
    row /= L_(k, k);
    values_ += row.cwiseAbs2().transpose();
  }
  for (int i = 0; i < m_; ++i) {
    row_[i].norm = std::sqrt(values_[i]);
    if (row_[i].norm > 0) N_.col(i) /= row_[i].norm;
  }
  return y0_.allFinite() && values_.allFinite();
}

/// False if a hard row is infeasible by itself.
bool QuadraticProgramSolver::set_bounds(const QuadraticProgram& program) noexcept {
  for (int i = 0; i < m_; ++i) {
    auto [lower, upper, priority] = program.bounds[i];
    if (lower > upper) {
      // between its bounds a soft row has a constant total violation
      std::swap(lower, upper);
      if (upper - lower <= kEqual * std::max(std::abs(lower), std::abs(upper))) {
        lower = upper = 0.5 * (lower + upper);
      } else if (priority.level == 0) {
        return false;
      }
    }
    Row& row = row_[i];
    if (row.norm > 0) {
      row.lower = lower / row.norm;
      row.upper = upper / row.norm;
      continue;
    }
    row.lower = -kInfinity;
    row.upper = kInfinity;
    if (priority.level == 0 && (lower > 0 || upper < 0)) {
      multipliers_[i] = lower > 0 ? -1 : 1;
      return false;
    }
  }
  return true;
}

void QuadraticProgramSolver::price(const QuadraticProgram& program) noexcept {
  y_ = y0_;
  update_values();
  double broken = 0;
  for (int i = 0; i < m_; ++i) {
    broken = std::max({broken, values_[i] - row_[i].upper, row_[i].lower - values_[i]});
  }
  scale_ = y0_.norm() + broken;
  for (int i = 0; i < m_; ++i) {
    const RowPriority& priority = program.bounds[i].priority;
    row_[i].price =
        priority.level == 0 ? kInfinity : kPrices[priority.level] * priority.weight * scale_;
  }
}

/// Warm start: the rows that were active, as far as they are still independent, and those that were
/// relaxed. project() then drops those that are not optimal, so that the start is dual feasible.
void QuadraticProgramSolver::take_active_rows() noexcept {
  const int count = factor_.count();
  const auto before = active_;
  factor_.clear(n_);
  for (int i = 0; i < m_; ++i) {
    Row& row = row_[i];
    if (row.state == State::kActive) continue;
    const bool bounded = std::isfinite(row.state == State::kAbove ? row.upper : row.lower);
    if (row.state == State::kFree || std::isinf(row.price) || !bounded) {
      release(row);
    } else {
      row.multiplier = row.state == State::kAbove ? row.price : -row.price;
    }
  }
  for (int j = 0; j < count; ++j) {
    Row& row = row_[before[j]];
    release(row);
    if (!std::isfinite(row.at_upper ? row.upper : row.lower)) continue;
    factor_.split(N_.col(before[j]), inside_, outside_);
    if (outside_.norm() < kDependentAtStart) continue;
    active_[factor_.count()] = before[j];
    factor_.append(inside_, outside_);
    row.state = State::kActive;
  }
  project();
}

QuadraticProgramSolver::Status QuadraticProgramSolver::iterate() noexcept {
  bool projected = true;
  for (;;) {
    update_values();
    tolerance_ = kTolerance * (scale_ + y_.norm());
    double sign = 0;
    const int row = most_broken(sign);
    if (row >= 0) {
      const Status status = settle(row, sign);
      if (status != Status::kOptimal) return status;
      projected = false;
    } else if (!projected) {
      project();  // removes the rounding errors accumulated by the steps
      projected = true;
    } else {
      return Status::kOptimal;
    }
  }
}

/// Row whose multiplier has the largest possible gain, and the sign of its change: violated, or
/// relaxed although it holds. -1 if there is none.
int QuadraticProgramSolver::most_broken(double& sign) const noexcept {
  int worst = -1;
  double most = tolerance_;
  const auto look = [&](int row, double broken, double direction) {
    if (broken <= most) return;
    worst = row;
    most = broken;
    sign = direction;
  };
  for (int i = 0; i < m_; ++i) {
    const Row& row = row_[i];
    const double value = values_[i];
    switch (row.state) {
      case State::kFree:
        look(i, value - row.upper, 1);
        look(i, row.lower - value, -1);
        break;
      case State::kAbove:
        look(i, row.upper - value, -1);
        break;
      case State::kBelow:
        look(i, value - row.lower, 1);
        break;
      case State::kActive:
        break;
    }
  }
  return worst;
}

/// Changes the multiplier of `index` until the row holds and becomes active or its multiplier
/// reaches a bound; active rows whose multipliers reach a bound on the way are removed.
QuadraticProgramSolver::Status QuadraticProgramSolver::settle(int index, double sign) noexcept {
  Row& row = row_[index];
  if (row.state == State::kFree) row.at_upper = sign > 0;
  normal_ = N_.col(index);
  for (;;) {
    if (++iterations_ > kMostIterations) return Status::kIterationLimit;
    factor_.split(normal_, inside_, outside_);
    Vector follow = inside_;
    factor_.solve(follow);
    const double independent = outside_.norm();
    const bool dependent = independent <= kDependent;

    const double bound = row.at_upper ? row.upper : row.lower;
    const double broken = std::max(0.0, sign * (normal_.dot(y_) - bound));
    const double to_hold = dependent ? kInfinity : broken / (independent * independent);
    const double to_own_bound =
        sign > 0 ? row.greatest() - row.multiplier : row.multiplier - row.least();
    double step = std::min(to_hold, to_own_bound);
    int leaving = -1;
    for (int k = 0; k < factor_.count(); ++k) {
      const Row& other = row_[active_[k]];
      const double rate = -sign * follow[k];
      if (std::abs(rate) <= kUnchanged) continue;
      const double room =
          rate > 0 ? other.greatest() - other.multiplier : other.multiplier - other.least();
      const double to_bound = std::max(0.0, room) / std::abs(rate);
      if (to_bound < step) {
        step = to_bound;
        leaving = k;
      }
    }
    if (step == kInfinity) {
      set_ray(index, sign, follow);
      return Status::kInfeasible;
    }

    for (int k = 0; k < factor_.count(); ++k) {
      row_[active_[k]].multiplier -= step * sign * follow[k];
    }
    row.multiplier += step * sign;
    if (!dependent) y_ -= step * sign * outside_;
    if (leaving >= 0) {
      Row& other = row_[active_[leaving]];
      other.multiplier = sign * follow[leaving] < 0 ? other.greatest() : other.least();
      leave(leaving);
    } else if (step == to_hold) {
      active_[factor_.count()] = index;
      factor_.append(inside_, outside_);
      row.state = State::kActive;
      return Status::kOptimal;
    } else {
      row.multiplier = sign > 0 ? row.greatest() : row.least();
      row.state = row.multiplier > 0   ? State::kAbove
                  : row.multiplier < 0 ? State::kBelow
                                       : State::kFree;
      return Status::kOptimal;
    }
  }
}

/// Multipliers can grow without bound along this ray: its rows contradict each other (Farkas).
void QuadraticProgramSolver::set_ray(int index, double sign, const Vector& follow) noexcept {
  multipliers_[index] = sign / row_[index].norm;
  for (int k = 0; k < factor_.count(); ++k) {
    if (std::abs(follow[k]) > kUnchanged) {
      multipliers_[active_[k]] = -sign * follow[k] / row_[active_[k]].norm;
    }
  }
  multipliers_ /= multipliers_.cwiseAbs().maxCoeff();
}

/// Deactivates the active row at `position` of the factor, whose multiplier is at a bound.
void QuadraticProgramSolver::leave(int position) noexcept {
  Row& row = row_[active_[position]];
  row.state = row.multiplier > 0   ? State::kAbove
              : row.multiplier < 0 ? State::kBelow
                                   : State::kFree;
  factor_.remove(position);
  for (int k = position; k < factor_.count(); ++k) active_[k] = active_[k + 1];
}

void QuadraticProgramSolver::release(Row& row) noexcept {
  row.state = State::kFree;
  row.multiplier = 0;
}

/// Recomputes y and the multipliers of the active rows from these rows alone, without those whose
/// multipliers would be out of bounds.
void QuadraticProgramSolver::project() noexcept {
  for (;;) {
    Vector start = y0_;
    double greatest = scale_;
    for (int i = 0; i < m_; ++i) {
      const Row& row = row_[i];
      if (row.state != State::kAbove && row.state != State::kBelow) continue;
      start -= row.multiplier * N_.col(i);
      greatest = std::max(greatest, row.price);
    }
    const int count = factor_.count();
    Vector bounds(count);
    for (int k = 0; k < count; ++k) {
      const Row& row = row_[active_[k]];
      bounds[k] = row.at_upper ? row.upper : row.lower;
    }
    factor_.solve_transposed(bounds);
    factor_.split(start, inside_, y_);
    y_.noalias() += factor_.basis().lazyProduct(bounds);
    inside_ -= bounds;
    factor_.solve(inside_);
    int worst = -1;
    double most = kTolerance * std::max(greatest, count > 0 ? inside_.cwiseAbs().maxCoeff() : 0);
    for (int k = 0; k < count; ++k) {
      Row& row = row_[active_[k]];
      row.multiplier = std::clamp(inside_[k], row.least(), row.greatest());
      const double outside = std::abs(inside_[k] - row.multiplier);
      if (outside > most) {
        worst = k;
        most = outside;
      }
    }
    if (worst < 0) return;
    leave(worst);
  }
}

void QuadraticProgramSolver::update_values() noexcept {
  values_.setZero(m_);
  for (int k = 0; k < n_; ++k) values_ += y_[k] * N_.row(k).head(m_).transpose();
}

void QuadraticProgramSolver::publish(const QuadraticProgram& program) noexcept {
  u_ = y_;
  L_.triangularView<Eigen::Lower>().adjoint().solveInPlace(u_);
  values_.setZero(m_);
  for (int k = 0; k < n_; ++k) values_ += u_[k] * program.A.row(k).head(m_).transpose();
  const bool proof = !multipliers_.isZero(0);
  for (int i = 0; i < m_; ++i) {
    const Row& row = row_[i];
    if (!proof && row.norm > 0) multipliers_[i] = row.multiplier / row.norm;
    const double above = values_[i] - program.bounds[i].upper;
    const double below = program.bounds[i].lower - values_[i];
    if (std::max(above, below) > 2 * tolerance_ * row.norm) {
      violations_[i] = above > below ? above : -below;
    }
  }
}

double QuadraticProgramSolver::worst_violation(const QuadraticProgram& program,
                                               int level) const noexcept {
  double worst = 0;
  for (int i = 0; i < violations_.size(); ++i) {
    if (program.bounds[i].priority.level != level) continue;
    worst = std::max(worst, std::abs(violations_[i]));
  }
  return worst;
}

}  // namespace palpate::math
