#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <map>
#include <mutex>
#include <string>

#include "tools/fit/problem.hpp"

namespace palpate::fit {

/// The best parameters so far of every fit of a plan, in a JSON file that is replaced atomically,
/// so that an interrupted fit can be resumed. Thread-safe.
class Checkpoint {
 public:
  /// No file if `path` is empty. Reads an existing file if `resumes`: throws std::runtime_error if
  /// it is damaged or belongs to another plan, by its hash.
  Checkpoint(std::filesystem::path path, std::string hash, bool resumes);

  /// Start of the fit: the stored coordinates, otherwise the problem's own.
  Eigen::VectorXd start(const std::string& fit, const Problem& problem) const;

  /// Stores the coordinates if their cost is the lowest so far, and writes at most once a second;
  /// `is_last` always writes.
  void keep(const std::string& fit, const Problem& problem, const Eigen::VectorXd& coordinates,
            double cost, bool is_last);

  /// Deletes the file once all fits are done.
  void remove() const;

 private:
  struct Best {
    double cost = 0;
    std::map<std::string, double> values;  // of free parameters
    bool is_old = false;                   // from an earlier call: any new cost replaces it
  };
  void write();

  std::filesystem::path path_;
  std::string hash_;
  mutable std::mutex mutex_;
  std::map<std::string, Best> best_;
  double last_written_ = 0;
};

}  // namespace palpate::fit
