#include "tools/view/encode.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "rt/bus/text.hpp"
#include "tools/common/discrepancy_text.hpp"

namespace palpate::view {

using nlohmann::json;

namespace {

/// Micrometres and micronewtons are finer than the image; more digits make the text long.
json number(double x) { return std::isfinite(x) ? json(std::round(x * 1e6) / 1e6) : json(); }

template <class Number>
json numbers(const Number* x, int count) {
  json list = json::array();
  for (int i = 0; i < count; ++i) list.push_back(number(static_cast<double>(x[i])));
  return list;
}

}  // namespace

std::string encode_mesh(const char* role, const shape_mesh_t& mesh) {
  std::set<std::int32_t> middles;  // of the edges of quadratic tetrahedra
  for (std::size_t i = 0; mesh.element_size == 10 && i < mesh.elements.size(); ++i)
    if (i % 10 >= 4) middles.insert(mesh.elements[i]);
  const std::vector<std::int32_t> middle_list(middles.begin(), middles.end());
  serve::Parcel parcel(
      {{"type", "mesh"},
       {"role", role},
       {"hash", serve::hash_text(mesh.mesh_hash)},
       {"nodes", mesh.node_count},
       {"elements", mesh.elements.size() / static_cast<std::size_t>(mesh.element_size)}});
  parcel.add("rest", mesh.rest_xyz);
  parcel.add("triangles", mesh.triangles);
  parcel.add("constrained", mesh.constrained);
  parcel.add("middles", middle_list);
  return parcel.finish();
}

json to_json(const biotac_t& b) {
  return {{"valid", b.valid},
          {"electrodes", b.electrodes},
          {"pdc", b.pdc},
          {"tac", b.tac},
          {"tdc", b.tdc},
          {"seq", b.seq},
          {"session", serve::hash_text(b.session)}};
}

json to_json(const contacts_t& contacts) {
  json list = json::array();
  for (int i = 0; i < contacts.count; ++i) {
    list.push_back({{"source", contacts.source[i]},
                    {"at", numbers(contacts.location[i], 3)},
                    {"wrench", numbers(contacts.wrench[i], 6)},
                    {"deviation", number(contacts.deviation[i])}});
  }
  return list;
}

json predicted_json(const contacts_t& contacts) {
  json sums = json::array(), points = json::array();
  for (int o = 0; o < contacts.obstacle_count; ++o)
    sums.push_back({{"obstacle", bus::get_text(contacts.obstacle_name[o])},
                    {"force", number(contacts.obstacle_force[o])}});
  for (int i = 0; i < contacts.predicted_count; ++i) {
    float force[3];
    for (int k = 0; k < 3; ++k)
      force[k] = contacts.predicted_force[i] * contacts.predicted_normal[i][k] +
                 contacts.predicted_friction[i][k];
    points.push_back({{"at", numbers(contacts.predicted_place[i], 3)},
                      {"force", numbers(force, 3)},
                      {"slips", contacts.predicted_slips[i] != 0}});
  }
  return {{"sum", sums}, {"points", points}};
}

json to_json(const discrepancy_t& d) {
  json explanations = json::array(), wrenches = json::array();
  for (int i = 0; i < common::explanation_count(d); ++i)
    explanations.push_back(
        {{"text", common::explanation_text(d, i)}, {"probability", number(d.probability[i])}});
  for (int g = 0; g < d.grasp_count; ++g)
    wrenches.push_back(
        {{"difference", numbers(d.difference[g], 6)}, {"deviation", numbers(d.deviation[g], 6)}});
  json adopted;  // null: none
  if (d.adopted != discrepancy_t::CAUSE_UNKNOWN) adopted = common::cause_text(d.adopted);
  return {{"inconsistent", d.inconsistent != 0},
          {"duration", number(d.duration)},
          {"test", number(d.test)},
          {"threshold", number(d.threshold)},
          {"component", common::component_text(d)},
          {"explanations", explanations},
          {"wrenches", wrenches},
          {"adopted", adopted}};
}

json to_json(const estimate_t& e) {
  json grasps = json::array();
  for (int g = 0; g < e.grasp_count; ++g) {
    grasps.push_back({{"at", numbers(e.grasp_position[g], 3)},
                      {"quaternion", numbers(e.grasp_quaternion[g], 4)},
                      {"wrench", numbers(e.reaction[g], 6)}});
  }
  return {{"status", e.status},
          {"grasps", grasps},
          {"young_modulus", number(std::exp(e.log_young_modulus))},
          {"young_modulus_share", number(e.log_young_modulus_deviation)},
          {"poisson_ratio", number(e.poisson_ratio)},
          {"poisson_ratio_deviation", number(e.poisson_ratio_deviation)},
          {"innovation", number(e.innovation_test)},
          {"unknown_at", numbers(e.unknown_contact_location, 3)},
          {"unknown_force", numbers(e.unknown_contact_force, 3)},
          {"unknown_deviation", number(e.unknown_contact_deviation)}};
}

json to_json(const feature_t& f) {
  return {{"kind", bus::get_text(f.kind)},
          {"revision", f.revision},
          {"value", numbers(f.value, f.value_count)},
          {"target", numbers(f.target, f.value_count)},
          {"error", numbers(f.error, f.error_count)},
          {"unreachable", numbers(f.unreachable, f.error_count)}};
}

json to_json(const health_t& h) {
  json inputs = json::array(), models = json::array();
  for (int i = 0; i < h.input_count; ++i) {
    inputs.push_back({{"name", bus::get_text(h.input_name[i])},
                      {"received", h.received[i]},
                      {"lost", h.lost[i]},
                      {"rejected", h.rejected[i]},
                      {"frozen", h.frozen[i]},
                      {"age_ms", number(static_cast<double>(h.age_ms[i]))}});
  }
  for (int i = 0; i < h.model_count; ++i) {
    models.push_back({{"name", bus::get_text(h.model_name[i])},
                      {"executor", bus::get_text(h.model_executor[i])},
                      {"steps", h.model_steps[i]},
                      {"late", h.model_late[i]},
                      {"dropped", h.model_dropped[i]}});
  }
  return {{"state", h.state},
          {"reason", bus::get_text(h.reason)},
          {"cycles", h.cycles},
          {"overruns", h.overruns},
          {"overrun_us", h.overrun_us},
          {"not_converged", h.shapes_not_converged},
          {"page_faults", h.page_faults},
          {"allocations", h.allocations},
          {"p50_us", numbers(h.p50_us, h.phase_count)},
          {"p99_us", numbers(h.p99_us, h.phase_count)},
          {"max_us", numbers(h.max_us, h.phase_count)},
          {"inputs", inputs},
          {"models", models},
          {"malformed", h.malformed},
          {"overflowed", h.overflowed},
          {"telemetry_dropped", h.telemetry_dropped},
          {"gate_limited", h.gate_limited},
          {"gate_rejected", h.gate_rejected},
          {"commands_rejected", h.commands_rejected}};
}

json to_json(const truth_contact_t& t) {
  json grasps = json::array();
  for (int g = 0; g < t.grasp_count; ++g)
    grasps.push_back(
        {{"at", numbers(t.grasp_position[g], 3)}, {"wrench", numbers(t.grasp_wrench[g], 6)}});
  return grasps;
}

json to_json(const NumberedEvent& e) {
  return {{"number", e.number},
          {"time_us", e.time_us},
          {"slot", bus::get_text(e.event.slot)},
          {"instance", bus::get_text(e.event.instance)},
          {"component", bus::get_text(e.event.component)},
          {"event", bus::get_text(e.event.event)},
          {"answer", e.event.command_counter >= 0},
          {"reason", bus::get_text(e.event.reason)}};
}

json to_json(const types::MessageValues& messages, std::int64_t now_us) {
  constexpr std::size_t kMostShown = 200;  // values of a message
  json list = json::array();
  for (const types::ShownMessage& message : messages.shown(kMostShown)) {
    json lines = json::array();
    for (std::size_t i = 0; i < message.values.size();) {
      const std::size_t end = types::line_end(message.values, i);
      const auto [name, text] = types::line_of(message.values, i, end);
      lines.push_back({name, text});
      i = end;
    }
    list.push_back({{"channel", message.channel},
                    {"type", message.type},
                    {"age_ms", std::max<std::int64_t>(now_us - message.time_us, 0) / 1000},
                    {"fits", message.fits},
                    {"malformed", message.malformed},
                    {"left_out", message.left_out},
                    {"lines", lines}});
  }
  return list;
}

}  // namespace palpate::view
