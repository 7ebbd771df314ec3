#pragma once

#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "rt/config/node.hpp"

namespace palpate::registry {

struct Context;

/// Built-in components of a slot: name, one-line description, declared options and the function
/// that creates the component from them. `Inputs`: what the slot's components need in addition.
template <class Made, class... Inputs>
class Slot {
 public:
  using Create =
      std::function<std::unique_ptr<Made>(const config::Node&, const Context&, Inputs...)>;

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
                   const config::Node& node, const Context& context,
                   Inputs... inputs) -> std::unique_ptr<Made> {
                 return create(node.read(table), node, context, inputs...);
               });
  }

  /// Reads the name of a component of this slot, or of one of `plugins`. Throws config::Error
  /// listing the names.
  std::string name(const config::Node& node, const config::Key& key,
                   const std::vector<std::string>& plugins = {}) const {
    config::Choices known = choices_;
    for (const std::string& plugin : plugins) known.emplace_back(plugin, "Component of a plug-in");
    return node.component(key, known);
  }

  /// Creates the component of that name. Throws config::Error, at `key` of `node` ("": at the node
  /// itself) if the component rejects its options.
  std::unique_ptr<Made> make(const std::string& name, const std::string& key,
                             const config::Node& node, const Context& context,
                             Inputs... inputs) const {
    try {
      for (std::size_t i = 0; i < choices_.size(); ++i)
        if (choices_[i].first == name) return create_[i](node, context, inputs...);
    } catch (const std::invalid_argument& error) {
      node.fail(key, error.what());
    }
    node.fail(key, "'" + name + "' is unknown");
  }

 private:
  config::Choices choices_;
  std::vector<Create> create_;
};

}  // namespace palpate::registry
