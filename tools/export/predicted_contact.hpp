#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <palpate/contacts_t.hpp>

namespace palpate::exporting {

/// Contact with an obstacle that the model predicts, in O.
struct PredictedContact {
  Eigen::Vector3d place;  // m
  Eigen::Vector3d force;  // N, on the object: normal and friction force
};

/// Number of predicted contacts, whatever a damaged message says.
inline int predicted_count(const contacts_t& message) {
  return std::clamp<int>(message.predicted_count, 0, contacts_t::MOST_PREDICTED);
}

/// The contact `index` of those.
inline PredictedContact predicted_contact(const contacts_t& message, int index) {
  const auto vector = [](const float(&v)[3]) {
    return Eigen::Vector3d(Eigen::Map<const Eigen::Vector3f>(v).cast<double>());
  };
  return {vector(message.predicted_place[index]),
          message.predicted_force[index] * vector(message.predicted_normal[index]) +
              vector(message.predicted_friction[index])};
}

}  // namespace palpate::exporting
