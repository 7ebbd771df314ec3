#pragma once

#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "rt/plugin/plugins.hpp"
#include "rt/registry/registry.hpp"

namespace palpate::registry {

/// Components of plug-ins; empty if `context` has none.
const plugin::PluginRegistrar& plugins_of(const Context& context);

/// Creates the component that `key` of `node` names, with its keys from `node`. `feature`: of a
/// Jacobian provider, evaluated on the rest shape. Throws config::Error, also for exceptions of the
/// plug-in, and for one that does not return within plugin::kSetupDeadline. Instantiated for the
/// interfaces of all slots.
template <class Plugin>
std::unique_ptr<typename Plugin::Core> make_plugin(const plugin::PluginEntry<Plugin>& entry,
                                                   const char* key, const config::Node& node,
                                                   const Context& context,
                                                   shape::Feature* feature = nullptr);

/// Components of a slot: those of plug-ins with the interface `Plugin`, and the built-in ones, each
/// with its name, one-line description, declared options and the function that creates it.
/// `Inputs`: what the slot's components need in addition.
template <class Plugin, class... Inputs>
class Slot {
 public:
  using Made = std::unique_ptr<typename Plugin::Core>;
  using Create = std::function<Made(const config::Node&, const Context&, Inputs...)>;
  using Plugins = plugin::PluginList<Plugin>;

  /// `key`: the one that names the component.
  Slot(config::Key key, Plugins plugin::PluginRegistrar::*plugins)
      : key_(std::move(key)), plugins_(plugins) {}

  /// A component that reads its keys itself.
  Slot& add(std::string name, std::string description, Create create) {
    choices_.emplace_back(std::move(name), std::move(description));
    create_.push_back(std::move(create));
    return *this;
  }

  /// `create(options, node, context, inputs...)`; keys that cannot be declared in a table, such as
  /// files, are read from `node`.
  template <class Options, class From>
  Slot& add(std::string name, std::string description, config::OptionTable<Options> table,
            From create) {
    return add(std::move(name), std::move(description),
               [table = std::move(table), create = std::move(create)](
                   const config::Node& node, const Context& context, Inputs... inputs) -> Made {
                 return create(node.read(table), node, context, inputs...);
               });
  }

  /// Reads the name of the component. Throws config::Error listing the known ones.
  std::string name(const config::Node& node, const Context& context) const {
    config::Choices known = choices_;
    for (const auto& entry : (plugins_of(context).*plugins_).entries())
      known.emplace_back(entry.name, "Component of a plug-in");
    return node.component(key_, known);
  }

  /// Creates the component that `node` names. Throws config::Error, also if the component rejects
  /// its options.
  Made make(const config::Node& node, const Context& context, Inputs... inputs) const {
    const std::string name = this->name(node, context);
    if (const auto* entry = plugin::find_plugin(plugins_of(context).*plugins_, name))
      return make_plugin(*entry, key_.name.c_str(), node, context, &inputs...);
    std::size_t i = 0;
    while (choices_[i].first != name) ++i;
    try {
      return create_[i](node, context, inputs...);
    } catch (const std::invalid_argument& error) {
      node.fail(key_.name == "component" ? "" : key_.name, error.what());
    }
  }

 private:
  config::Key key_;
  Plugins plugin::PluginRegistrar::*plugins_;
  config::Choices choices_;
  std::vector<Create> create_;
};

/// Creates a component from its options and, where its constructor takes them, the object's body
/// and surface.
template <class Made>
auto from_options() {
  return [](const auto& options, const config::Node&, const Context& context) {
    using Options = decltype(options);
    if constexpr (std::is_constructible_v<Made, const elasticity::Body&, const mesh::Surface&,
                                          Options>)
      return std::make_unique<Made>(context.object->body, context.object->surface, options);
    else if constexpr (std::is_constructible_v<Made, const elasticity::Body&, Options>)
      return std::make_unique<Made>(context.object->body, options);
    else
      return std::make_unique<Made>(options);
  };
}

}  // namespace palpate::registry
