#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "tools/recordings/errors.hpp"
#include "tools/train/fit.hpp"

namespace palpate::train {

/// One prediction method, and its error on the scored part.
struct Method {
  std::string name;
  std::vector<Eigen::MatrixXd> predictions;  // of each recording
  recordings::Errors errors;
  bool tared = false;  // errors are tared over the first seconds of each recording
};

struct Score {
  recordings::Part part = recordings::Part::kTest;  // kValidation if there is no test row
  std::vector<Method> methods;
  Eigen::VectorXd largest_trained;  // per output: largest magnitude among training rows
  Eigen::VectorXd largest_scored;
};

/// The network, the ridge, the training mean and, for a wrist, the rigid payload (each also with a
/// new tare). A network trained on windows is scored streamed and by windows.
Score score_fit(const recordings::Plan& plan, const recordings::DataSet& data, const Fit& fit);

void print_score(const recordings::Plan& plan, const recordings::DataSet& data, const Score& score,
                 std::ostream& out);

/// The card without hash, architecture and states, which are added with the file.
inference::ModelCard make_card(const recordings::Plan& plan, const recordings::DataSet& data,
                               const Fit& fit, const Score& score);

/// Learning curve and predictions with the ground truth. False, with the reason on standard error,
/// if they could not be drawn.
bool draw_fit(const recordings::Plan& plan, const recordings::DataSet& data, const Fit& fit,
              const Score& score, const std::string& picture);

}  // namespace palpate::train
