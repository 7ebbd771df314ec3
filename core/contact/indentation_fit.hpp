#pragma once

#include <Eigen/Core>
#include <array>

#include "core/contact/approach_record.hpp"

namespace palpate::contact {

/// Where a tip first touched a soft surface, from the force recorded while it sank in.
///
/// Model: F = b + F1 ((s - s0) / D)^n beyond the point of touch s0, F = b before it, with travel s
/// and a constant offset b of the force. n = 3/2: rigid ball on an elastic half-space (Hertz,
/// F = 4/3 E / (1 - nu^2) sqrt(R) d^(3/2); Johnson, Contact Mechanics, 1985, 4.2). n = 1: flat
/// punch. n = 2: cone, or foundation under a ball. D is a constant reference depth, which makes F1
/// and n nearly uncorrelated.
///
/// Weighted least squares over s0, F1, b and n by Levenberg-Marquardt. n and b have normal priors:
/// a real surface, thick or thin, curved or edged, keeps to no exponent exactly, and without that
/// freedom the deviation of s0 would be too small. The variance of a sample is estimated from the
/// residuals and multiplied by their integrated autocorrelation time, because neighbouring
/// residuals of a filtered or disturbed force, or of a law that does not fit, are not independent.
///
/// A sensor with play P reads a rising force by p too small and shows the touch too deep, by the
/// depth at which the force is p. Where in its play it rests is unknown: p is uniform in [0, P];
/// the mean of its effect is subtracted, and its range widens the deviation.
///
/// Work is divided over calls: advance() evaluates the model once for each step of the record
/// (at most 512 powers). Nothing allocates.
class IndentationFit {
 public:
  struct Options {
    double exponent = 1.5;            // n, mean of its prior; 1 to 3
    double exponent_deviation = 0.2;  // standard deviation of the prior of n; 0: n is constant
    double bias_deviation = 0.03;     // N, standard deviation of the prior of b; > 0
    double force_play = 0;  // N, by which a force rises at most before the sensor reads it

    /// Throws std::invalid_argument naming the option and its range.
    void check() const;
  };

  struct Result {
    bool valid = false;
    const char* reason = "";         // why not
    double touch = 0;                // m, s0
    double touch_deviation = 0;      // m
    double indentation = 0;          // m, depth at the last step
    double force = 0;                // N, of the model at the last step, without b; with the play
    double stiffness = 0;            // N/m, force / indentation
    double stiffness_deviation = 0;  // N/m
    double exponent = 0;             // n
    double noise = 0;                // N, standard deviation of a sample
    double correlation = 1;          // integrated autocorrelation time, steps, at least 1
  };

  /// Throws std::invalid_argument as Options::check().
  explicit IndentationFit(const Options& options);

  /// Begins with a record that ends at the largest force; it must stay unchanged until done().
  void begin(const ApproachRecord& record) noexcept;
  /// One iteration; call until done().
  void advance() noexcept;
  bool done() const noexcept { return stage_ == Stage::kDone; }
  const Result& result() const noexcept { return result_; }

 private:
  enum class Stage { kLaw, kAll, kDone };  // first with the exponent of the prior, then with all
  using Vector = Eigen::Vector4d;          // s0, F1, b, n
  using Matrix = Eigen::Matrix4d;
  struct Sums {
    double squares = 0;  // of weighted residuals, N^2
    Matrix normal = Matrix::Zero();
    Vector gradient = Vector::Zero();
  };

  bool guess() noexcept;
  Sums evaluate(const Vector& parameters) const noexcept;
  double cost(const Sums& sums, const Vector& parameters) const noexcept;
  Matrix information(const Sums& sums) const noexcept;
  bool frees_exponent() const noexcept {
    return stage_ != Stage::kLaw && options_.exponent_deviation > 0;
  }
  void propose() noexcept;
  void find_noise() noexcept;
  void next_stage() noexcept;
  void conclude() noexcept;
  void correct_for_play() noexcept;
  void fail(const char* reason) noexcept;
  double residual(const Vector& parameters, int i) const noexcept;

  Options options_;
  const ApproachRecord* record_ = nullptr;
  Stage stage_ = Stage::kDone;
  int begin_ = 0;        // first step of the record that is fitted
  double depth_ = 1;     // m, D
  double variance_ = 1;  // N^2, of a sample, correlation included
  Vector best_ = Vector::Zero(), trial_ = Vector::Zero();
  Sums sums_;  // at best_
  double best_cost_ = 0;
  bool has_best_ = false;
  double damping_ = 0;
  int iterations_ = 0;
  std::array<double, ApproachRecord::kMostSteps> residuals_{};  // N, weighted
  Result result_;
};

}  // namespace palpate::contact
