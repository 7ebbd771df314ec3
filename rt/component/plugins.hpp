#pragma once

#include <memory>
#include <string>
#include <vector>

#include "rt/component/plugin.hpp"
#include "rt/config/node.hpp"

namespace palpate::component {

struct Context;

/// The components of a user's own libraries, which the list `plugins` of the configuration names:
///   plugins:
///     - library: path/libmine.so   # relative to the file that says it
/// A library stays loaded until the process ends, since what it made may live as long.
class Plugins {
 public:
  /// Loads and registers. Throws config::Error with file and key: a library that cannot be loaded,
  /// is none of palpate's, was built for another palpate, or whose registration throws, or names a
  /// component or key wrongly or twice. No key: no components.
  static std::shared_ptr<const Plugins> load(const config::Node& root);

  const PluginRegistrar& components() const noexcept { return components_; }

 private:
  void add(const std::string& path, const config::Node& item);

  PluginRegistrar components_;
};

/// The built-in names, and after them those of plug-ins.
template <class Component>
std::vector<std::string> with_plugins(std::vector<std::string> names,
                                      const std::vector<PluginEntry<Component>>& entries) {
  for (const PluginEntry<Component>& entry : entries) names.push_back(entry.name);
  return names;
}

/// The entry of that name; nullptr where no plug-in has it.
template <class Component>
const PluginEntry<Component>* find_plugin(const std::vector<PluginEntry<Component>>& entries,
                                          const std::string& name) {
  for (const PluginEntry<Component>& entry : entries)
    if (entry.name == name) return &entry;
  return nullptr;
}

/// What plug-ins have; empty where `context` knows of none.
const PluginRegistrar& plugins_of(const Context& context);

/// Makes a component with its keys from `node`. Throws config::Error, also with what it throws.
std::unique_ptr<sensing::SensorModel> make_plugin(const PluginEntry<PluginSensorModel>& entry,
                                                  const config::Node& node, const Context& context);
std::unique_ptr<contact::ForceTransformer> make_plugin(
    const PluginEntry<PluginForceTransformer>& entry, const config::Node& node,
    const Context& context);
std::unique_ptr<control::JacobianProvider> make_plugin(
    const PluginEntry<PluginJacobianProvider>& entry, const config::Node& node,
    const Context& context);
std::unique_ptr<control::ControlLaw> make_plugin(const PluginEntry<PluginControlLaw>& entry,
                                                 const config::Node& node, const Context& context);

}  // namespace palpate::component
