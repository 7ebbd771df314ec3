#pragma once

namespace palpate::faults {

/// Requests that a user may make while the loop runs: the event replace.
struct Wish {
  const char* slot;
  const char* component;
  const char* parameters;
};

inline constexpr Wish kWishes[] = {
    {"object", "", "order: quadratic"},
    {"object", "", "order: linear"},
    {"object", "", "mesh: {box: {size: [0.5, 0.06, 0.06], cells: [4, 1, 1]}}"},
    {"object", "", "mesh: {box: {size: [0.5, 0.06, 0.06], cells: [6, 1, 1]}}"},
    {"deformation", "corotational_dynamic", ""},
    {"deformation", "corotational_quasistatic", ""},
    // Linear elements are stiffer than the object, which the test of the wrenches would report.
    {"estimation", "pose_wrench_filter", "consistency_test: false"},
    {"estimation", "pose_driven", ""},
    {"control", "", "provider: kinematic"},
    {"control", "", "provider: fem"},
    {"control", "", "gain: 0.7"},
    {"sensing", "ft_newton_euler", "payload: {mass: 4.8, center_of_mass: [0, 0, 0.11]}"},
    {"all", "", "{object: {order: quadratic}, control: {provider: kinematic}}"},
    // Requests that must be rejected.
    {"slot", "", "a: 1"},
    {"gate", "", "force: 100"},
    {"deformation", "corotational_dynamic", "iterations: 1000"},
    {"deformation", "no_such_model", ""},
    {"deformation", "corotational_dynamic", "{iterations: 3"},
    {"object", "", "mesh: {box: {size: [1.5, 0.06, 0.06], cells: [6, 1, 1]}}"},
    {"object", "", "mesh: {file: no_such_file.msh}"},
    {"object", "", "material: {young_modulus: .nan}"},
    {"sensing", "biotac_lstm", "{finger: 0, model_file: no_such_model.pt}"},
};

}  // namespace palpate::faults
