#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <map>
#include <mutex>
#include <string>

#include "tools/fit/problem.hpp"

namespace palpate::fit {

/// The best parameters so far of every fit of a plan, in a JSON file that is replaced in one go
/// whenever it is written, so that a fit that was ended can go on. Threads may share it.
class Checkpoint {
 public:
  /// No file where `path` is empty. Reads what is there where `resumes`: throws std::runtime_error
  /// where it is damaged or of another plan, by the hash.
  Checkpoint(std::filesystem::path path, std::string hash, bool resumes);

  /// Where to start the fit: what was kept, else the problem's own.
  Eigen::VectorXd start(const std::string& fit, const Problem& problem) const;

  /// Keeps the coordinates where their cost is the least so far, and writes at most once a second;
  /// `is_last` writes in any case.
  void keep(const std::string& fit, const Problem& problem, const Eigen::VectorXd& coordinates,
            double cost, bool is_last);

  /// Everything is done: the file is no longer needed.
  void remove() const;

 private:
  struct Best {
    double cost = 0;
    std::map<std::string, double> values;  // of free parameters
    bool is_old = false;                   // from before: any new cost replaces it
  };
  void write();

  std::filesystem::path path_;
  std::string hash_;
  mutable std::mutex mutex_;
  std::map<std::string, Best> best_;
  double last_written_ = 0;
};

}  // namespace palpate::fit
