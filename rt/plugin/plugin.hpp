#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "rt/config/option.hpp"
#include "rt/plugin/plugin_components.hpp"

namespace palpate::plugin {

/// Incremented whenever a header included by plug-ins changes incompatibly.
inline constexpr int kPluginInterface = 9;

/// Properties that must match between the host and a library, because C++ classes cross the
/// boundary.
struct PluginAbi {
  std::uint32_t magic;
  std::uint32_t size;  // of this structure
  std::int32_t interface;
  std::int32_t compiler;                     // version of the C++ ABI
  std::int32_t strings;                      // variant of std::string
  std::int32_t eigen;                        // version of Eigen
  std::int32_t alignment, static_alignment;  // of Eigen's types, bytes
  /// Whether Eigen allocates by malloc() or, as with AVX, by a function of its own. A matrix that
  /// one side allocates the other may free.
  std::int32_t malloc_aligned;
  std::int32_t signals, contacts, inputs, outputs, cell, model;  // sizes of structures
  std::int32_t measurements, estimate, sensitivity, option;      // sizes of structures
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
    EIGEN_MAX_STATIC_ALIGN_BYTES,
    EIGEN_MALLOC_ALREADY_ALIGNED,
    sizeof(sensing::Signals),
    sizeof(sensing::ContactSet),
    sizeof(control::LawInputs),
    sizeof(PluginLawOutput),
    sizeof(PluginCell),
    sizeof(elasticity::Body),
    sizeof(estimation::EstimationInputs),
    sizeof(estimation::Estimate),
    sizeof(elasticity::Sensitivity),
    sizeof(config::Option),
    PALPATE_VERSION};

/// Kind of sensor of a sensor model: a fallback must be of the same kind, and only wrist models may
/// belong to the second arm. A model of kFinger has the key `finger`, see PluginCell.
enum class SensorKind { kWrist, kFinger, kOther };

/// Component of a library: its name in the configuration, its keys, and its factory function, which
/// may throw any std::exception with an error message.
template <class Component>
struct PluginEntry {
  /// Guarded by the host; or of the interface of the built-in components, which is called directly
  /// and must keep its promises: an exception of it ends the daemon.
  using Made = std::variant<std::unique_ptr<Component>, std::unique_ptr<typename Component::Core>>;

  std::string name;                     // a-z, 0-9 and _, at most 31 characters
  std::vector<config::Option> options;  // a key `section.key` lies in a mapping of the component
  /// From a value for each option.
  std::function<Made(const std::vector<config::OptionValue>&, const PluginCell&)> make;
  SensorKind sensor = SensorKind::kOther;  // of sensor models
  /// Set by PluginList::add(): `make` returns the guarded interface, and has a deadline.
  bool is_guarded = true;
  std::string library = {};  // set by the host
};

/// Components of one slot.
template <class Component>
class PluginList {
 public:
  /// `table`: declares the keys; `make(options, cell)` returns a std::unique_ptr of the component.
  template <class Options, class Make>
  void add(std::string name, config::OptionTable<Options> table, Make make,
           SensorKind sensor = SensorKind::kOther) {
    PluginEntry<Component> entry;
    entry.name = std::move(name);
    for (const auto& declared : table.entries()) entry.options.push_back(declared.option);
    entry.make = [table = std::move(table), make = std::move(make)](
                     const std::vector<config::OptionValue>& values, const PluginCell& cell) {
      return typename PluginEntry<Component>::Made(make(table.make(values), cell));
    };
    entry.sensor = sensor;
    using Result = std::invoke_result_t<Make&, const Options&, const PluginCell&>;
    entry.is_guarded = std::is_convertible_v<Result, std::unique_ptr<Component>>;
    entries_.push_back(std::move(entry));
  }

  const std::vector<PluginEntry<Component>>& entries() const { return entries_; }
  std::vector<PluginEntry<Component>>& entries() { return entries_; }

 private:
  std::vector<PluginEntry<Component>> entries_;
};

/// Receives the components of a library; a name must be unique in its slot and differ from those of
/// built-in components.
struct PluginRegistrar {
  PluginList<PluginSensorModel> sensor_models;            // slot sensing
  PluginList<PluginForceTransformer> force_transformers;  // slot contact
  PluginList<PluginEstimator> estimators;                 // slot estimation
  PluginList<PluginDeformationModel> deformation_models;  // slot deformation
  PluginList<PluginFeature> features;                     // slot feature
  PluginList<PluginJacobianProvider> jacobian_providers;  // slot control, key provider
  PluginList<PluginControlLaw> control_laws;              // slot control, key law
};

}  // namespace palpate::plugin

/// Use once in a library, followed by a body that fills the registrar:
///   PALPATE_PLUGIN(registrar) { registrar.control_laws.add("mine", Mine::table(), make_mine); }
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
