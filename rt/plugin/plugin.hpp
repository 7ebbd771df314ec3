#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "rt/plugin/plugin_components.hpp"
#include "rt/plugin/plugin_parameters.hpp"

namespace palpate::plugin {

/// Incremented whenever a header included by plug-ins changes incompatibly.
inline constexpr int kPluginInterface = 1;

/// Properties that must match between the host and a library, because C++ classes cross the
/// boundary.
struct PluginAbi {
  std::uint32_t magic;
  std::uint32_t size;  // of this structure
  std::int32_t interface;
  std::int32_t compiler;                                         // version of the C++ ABI
  std::int32_t strings;                                          // variant of std::string
  std::int32_t eigen;                                            // version of Eigen
  std::int32_t alignment;                                        // of Eigen's types
  std::int32_t signals, contacts, inputs, outputs, cell, model;  // sizes of structures
  char version[16];                                              // of palpate
};

inline constexpr PluginAbi kPluginAbi = {
    0x70616c70,
    sizeof(PluginAbi),
    kPluginInterface,
    __GXX_ABI_VERSION,
    _GLIBCXX_USE_CXX11_ABI,
    EIGEN_WORLD_VERSION * 10000 + EIGEN_MAJOR_VERSION * 100 + EIGEN_MINOR_VERSION,
    EIGEN_MAX_ALIGN_BYTES,
    sizeof(sensing::Signals),
    sizeof(sensing::ContactSet),
    sizeof(control::LawInputs),
    sizeof(control::LawOutput),
    sizeof(PluginCell),
    sizeof(elasticity::Body),
    PALPATE_VERSION};

/// Kind of sensor of a sensor model: a fallback must be of the same kind, and only wrist models may
/// belong to the second arm. A model of kFinger has the key `finger`, see PluginCell.
enum class SensorKind { kWrist, kFinger, kOther };

/// Component of a library: its name in the configuration, its keys, and its factory function, which
/// may throw any std::exception with an error message.
template <class Component>
struct PluginEntry {
  std::string name;  // a-z, 0-9 and _, at most 31 characters
  std::vector<Parameter> parameters;
  std::function<std::unique_ptr<Component>(const Parameters&, const PluginCell&)> make;
  SensorKind sensor = SensorKind::kOther;  // of sensor models
};

/// Receives the components of a library; a name must be unique in its slot and differ from those of
/// built-in components.
struct PluginRegistrar {
  std::vector<PluginEntry<PluginSensorModel>> sensor_models;            // slot sensing
  std::vector<PluginEntry<PluginForceTransformer>> force_transformers;  // slot contact
  std::vector<PluginEntry<PluginJacobianProvider>> jacobian_providers;  // control, key provider
  std::vector<PluginEntry<PluginControlLaw>> control_laws;              // control, key law
};

}  // namespace palpate::plugin

/// Use once in a library, followed by a body that fills the registrar:
///   PALPATE_PLUGIN(registrar) { registrar.control_laws.push_back({"mine", {...}, make_mine}); }
/// If the body throws, the daemon does not start and reports the exception.
#define PALPATE_PLUGIN(registrar)                                                           \
  extern "C" {                                                                              \
  __attribute__((                                                                           \
      visibility("default"))) extern const ::palpate::plugin::PluginAbi palpate_plugin_abi; \
  const ::palpate::plugin::PluginAbi palpate_plugin_abi = ::palpate::plugin::kPluginAbi;    \
  __attribute__((visibility("default"))) void palpate_plugin_register(                      \
      ::palpate::plugin::PluginRegistrar&);                                                 \
  }                                                                                         \
  void palpate_plugin_register(::palpate::plugin::PluginRegistrar&(registrar))
