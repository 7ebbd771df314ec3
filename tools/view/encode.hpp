#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "tools/serve/parcel.hpp"
#include "tools/view/scene.hpp"

namespace palpate::view {

/// `role`: "estimate" or "truth".
std::string encode_mesh(const char* role, const shape_mesh_t& mesh);

/// Messages in the form that the page reads. Numbers that are not finite become null.
nlohmann::json to_json(const biotac_t& fingertip);
nlohmann::json to_json(const contacts_t& contacts);
/// Those that the model predicts: {sum: [{obstacle, force}], points: [{at, force, slips}]}, the
/// first by obstacle with its normal force, the second with vectors of force.
nlohmann::json predicted_json(const contacts_t& contacts);
nlohmann::json to_json(const discrepancy_t& discrepancy);
nlohmann::json to_json(const estimate_t& estimate);
nlohmann::json to_json(const feature_t& feature);
nlohmann::json to_json(const health_t& health);
nlohmann::json to_json(const truth_contact_t& contact);
nlohmann::json to_json(const NumberedEvent& event);
/// Of each message channel, type, age at `now_us`, and a line for each value or part of an array.
nlohmann::json to_json(const types::MessageValues& messages, std::int64_t now_us);

}  // namespace palpate::view
