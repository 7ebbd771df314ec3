#include "core/elasticity/contact/compliance_columns.hpp"

#include <algorithm>

namespace palpate::elasticity {

ComplianceColumns::ComplianceColumns(const std::vector<mesh::PointWeights>& samples, int unknowns,
                                     int most)
    : samples_(&samples),
      unknowns_(unknowns),
      place_of_(samples.size(), -1),
      sample_of_(samples.empty() ? 0 : most, -1) {
  const auto columns = 3 * static_cast<Eigen::Index>(sample_of_.size());
  responses_.setZero(columns > 0 ? 3 * unknowns : 0, columns);
  among_.setZero(columns, columns);
}

void ComplianceColumns::clear() noexcept {
  for (int place = 0; place < count_; ++place) place_of_[sample_of_[place]] = -1;
  count_ = 0;
}

void ComplianceColumns::assign(int sample, int place) noexcept {
  if (place == count_) {
    ++count_;
  } else {
    place_of_[sample_of_[place]] = -1;
  }
  sample_of_[place] = sample;
  place_of_[sample] = place;
}

/// Displacement of a sample per force at the sample in `place`.
Eigen::Matrix3f ComplianceColumns::at_sample(int sample, int place) const noexcept {
  Eigen::Matrix3f sum = Eigen::Matrix3f::Zero();
  const mesh::PointWeights& point = (*samples_)[sample];
  for (int i = 0; i < point.count; ++i) {
    if (point.nodes[i] >= unknowns_) continue;
    sum += static_cast<float>(point.weights[i]) *
           responses_.block<3, 3>(3 * point.nodes[i], 3 * place);
  }
  return sum;
}

/// Sets the compliance between the sample in `place` and all others, which is symmetric.
void ComplianceColumns::connect(int place) noexcept {
  for (int other = 0; other < count_; ++other) {
    const Eigen::Matrix3f block = at_sample(sample_of_[other], place);
    among_.block<3, 3>(3 * other, 3 * place) = block;
    among_.block<3, 3>(3 * place, 3 * other) = block.transpose();
  }
}

void ComplianceColumns::fill(const std::vector<int>& samples,
                             const factor::SupernodalFactor& factor, factor::Held held) {
  clear();
  const int count = std::min(samples.size(), sample_of_.size());
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(3 * unknowns_, 3 * count);
  for (int k = 0; k < count; ++k) {
    const mesh::PointWeights& point = (*samples_)[samples[k]];
    for (int i = 0; i < point.count; ++i) {
      if (point.nodes[i] >= unknowns_) continue;
      columns.block<3, 3>(3 * point.nodes[i], 3 * k).diagonal().array() += point.weights[i];
    }
  }
  factor.solve(columns, held);
  for (int k = 0; k < count; ++k) {
    assign(samples[k], k);
    responses_.middleCols<3>(3 * k) = columns.middleCols<3>(3 * k).cast<float>();
    connect(k);
  }
}

}  // namespace palpate::elasticity
