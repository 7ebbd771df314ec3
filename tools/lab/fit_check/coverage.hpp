#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "tools/fit/experiment.hpp"
#include "tools/fit/fit.hpp"

namespace palpate::fit_check {

/// An experiment whose recording is the model's prediction at `truth`, plus white noise with each
/// series' standard deviation.
class Synthetic final : public fit::Experiment {
 public:
  /// Throws std::invalid_argument if `truth` has no equilibrium.
  Synthetic(std::shared_ptr<const fit::Experiment> mechanics, const Eigen::VectorXd& truth,
            int seed);

  bool predict(const Eigen::VectorXd& parameters, Eigen::VectorXd& prediction,
               Eigen::MatrixXd* jacobian) const override {
    return mechanics_->predict(parameters, prediction, jacobian);
  }
  std::string material() const override { return mechanics_->material(); }

 private:
  std::shared_ptr<const fit::Experiment> mechanics_;
};

/// Coverage of the 95 % interval of a parameter.
struct Coverage {
  std::string experiment;
  std::string parameter;
  int seeds = 0;    // fits that identified the parameter
  int covered = 0;  // of them
  double mean_width =
      0;  // of the interval, relative to the truth's absolute value unless that is 0

  double share() const { return seeds > 0 ? static_cast<double>(covered) / seeds : 0; }
};

/// Fits `seeds` synthetic recordings; one row for each free parameter of the material, i.e. one
/// without a recording's name. `progress`: fraction done; returning false stops.
std::vector<Coverage> measure_coverage(std::shared_ptr<const fit::Experiment> mechanics,
                                       const Eigen::VectorXd& truth, int seeds,
                                       const std::function<void(double)>& progress = {});

/// An experiment with the true parameters of its synthetic recordings.
struct OwnModel {
  std::shared_ptr<const fit::Experiment> mechanics;
  Eigen::VectorXd truth;
};

/// Recordings that core's own models can generate: a bar in tension with its width, a bar that a
/// hand bends, pulls and twists, and one that oscillates after a stop. Files go to `folder`.
std::vector<OwnModel> own_models(const std::string& folder);

}  // namespace palpate::fit_check
