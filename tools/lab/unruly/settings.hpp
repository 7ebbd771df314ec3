#pragma once

#include <string>

namespace palpate::unruly {

/// Overrides of a configuration that load palpate-unruly.so and put its component into a slot.
/// `does`: kind of violation; `more`: further keys of the component, each after ", ", such as
/// ", after: 60", the cycles before the violation.
inline const std::string kLibrary = "plugins=[{library: palpate-unruly.so}]";

inline std::string sensor(const std::string& does, const std::string& more = "") {
  return "sensing=[{name: wrist, component: unruly_sensor, does: " + does + more + "}]";
}
inline std::string transformer(const std::string& does, const std::string& more = "") {
  return "contact=[{component: unruly_transformer, does: " + does + more + "}]";
}
inline std::string estimator(const std::string& does, const std::string& more = "") {
  return "estimation={component: unruly_estimator, does: " + does + more + "}";
}
inline std::string model(const std::string& does, const std::string& more = "") {
  return "deformation={component: unruly_model, does: " + does + more + "}";
}
inline std::string feature(const std::string& does, const std::string& more = "") {
  return "feature={component: unruly_feature, does: " + does + more + "}";
}
inline std::string provider(const std::string& does, const std::string& more = "") {
  return "control={provider: unruly_provider, law: proportional_twist, does: " + does + more + "}";
}
inline std::string law(const std::string& does, const std::string& more = "") {
  return "control={provider: fem, law: unruly_law, does: " + does + more + "}";
}

struct Slot {
  const char* name;
  const char* component;
  std::string (*configured)(const std::string& does, const std::string& more);
  const char* fallback;
};
/// The six slots, control with its two kinds of components.
inline constexpr Slot kSlots[] = {
    {"sensing", "unruly_sensor", sensor, "{component: ft_tare_only, tare_samples: 10}"},
    {"contact", "unruly_transformer", transformer, "{component: wrench_patch}"},
    {"estimation", "unruly_estimator", estimator, "{component: pose_driven}"},
    {"deformation", "unruly_model", model, "{component: corotational_quasistatic}"},
    {"feature", "unruly_feature", feature, "{component: point, rest_points: [[0.25, 0.03, 0.06]]}"},
    {"control_provider", "unruly_provider", provider, "{provider: fem, law: proportional_twist}"},
    {"control_law", "unruly_law", law, "{provider: fem, law: proportional_twist}"},
};

/// Violations of which every slot is capable: in the loop, where they are caught in their cycle,
/// and at set-up.
inline constexpr const char* kErrors[] = {"throw", "throw_number", "nan", "overrun"};
inline constexpr const char* kSetupErrors[] = {"fail_setup", "throw_warm_up", "hang_setup",
                                               "hang_warm_up"};

}  // namespace palpate::unruly
