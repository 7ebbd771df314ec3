#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/factor/supernodal_factor.hpp"
#include "core/mesh/point_locator.hpp"

namespace palpate::elasticity {

/// Responses of the unknown nodes to a force at surface samples, A^-1 N^T with the matrix A of a
/// factor, and the compliance among the samples, N A^-1 N^T (Duriez 2013; Courtecuisse et al.
/// 2014). Held for as long as the factor is: as forces and responses are in the axes at the
/// snapshot, rotation of the nodes since does not change them. Nothing allocates after
/// construction.
class ComplianceColumns {
 public:
  /// `samples`: nodes are unknowns in elimination order, or fixed from `unknowns` on; must outlive
  /// this object. `most`: largest number of samples in the table.
  ComplianceColumns(const std::vector<mesh::PointWeights>& samples, int unknowns, int most);

  void clear() noexcept;
  int count() const noexcept { return count_; }
  bool is_full() const noexcept { return count_ == static_cast<int>(sample_of_.size()); }
  /// Place of a sample in the table; -1 if absent.
  int place(int sample) const noexcept { return place_of_[sample]; }
  int sample(int place) const noexcept { return sample_of_[place]; }

  /// Adds the samples, as far as there is room, with double-precision solves. Allocates.
  void fill(const std::vector<int>& samples, const factor::SupernodalFactor& factor,
            factor::Held held);

  /// Adds a sample, or puts it in the place of another one: solve(b) overwrites a force on the
  /// unknowns, three coordinates each, with its response. `b`: workspace of that length.
  template <class Solve>
  void add(int sample, int place, Eigen::VectorXf& b, const Solve& solve) noexcept {
    assign(sample, place);
    for (int axis = 0; axis < 3; ++axis) {
      b.setZero();
      const mesh::PointWeights& point = (*samples_)[sample];
      for (int i = 0; i < point.count; ++i) {
        if (point.nodes[i] < unknowns_)
          b[3 * point.nodes[i] + axis] += static_cast<float>(point.weights[i]);
      }
      solve(b);
      responses_.col(3 * place + axis) = b;
    }
    connect(place);
  }

  /// Compliance, m/N: displacement of all samples in the table, three rows each, per force at the
  /// sample in `place`, three columns.
  auto among(int place) const noexcept {
    return among_.block(0, 3 * place, 3 * static_cast<Eigen::Index>(count_), 3);
  }
  Eigen::Matrix3f own(int place) const noexcept { return among_.block<3, 3>(3 * place, 3 * place); }
  /// Displacement, m, of the unknowns per force at the sample.
  auto response(int place) const noexcept { return responses_.middleCols<3>(3 * place); }

 private:
  void assign(int sample, int place) noexcept;
  void connect(int place) noexcept;
  Eigen::Matrix3f at_sample(int sample, int place) const noexcept;

  const std::vector<mesh::PointWeights>* samples_;
  int unknowns_;
  int count_ = 0;
  std::vector<int> place_of_, sample_of_;
  Eigen::MatrixXf responses_, among_;
};

}  // namespace palpate::elasticity
