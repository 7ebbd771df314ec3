#pragma once

#include <memory>
#include <string>

#include "rt/plugin/plugins.hpp"
#include "rt/registry/registry.hpp"

namespace palpate::support {

/// Builds the deformation model of the section `deformation`, on an example's bar. `library`: of
/// components, if not empty. Throws config::Error.
inline std::unique_ptr<elasticity::DeformationModel> configured_model(
    const std::string& deformation, const std::string& library = "") {
  const config::Node root = config::Node::load_file(
      std::string(PALPATE_SOURCE_DIR) + "/rt/config/examples/bar_long_soft.yaml",
      {"deformation=" + deformation,
       "plugins=[" + (library.empty() ? "" : "{library: " + library + "}") + "]"});
  registry::Context context;
  context.frames = registry::read_frames(root);
  context.plugins = plugin::Plugins::load(root);
  const registry::Object object = registry::read_object(root, context.frames);
  context.object = &object;
  const config::Node node = root.child("deformation");
  auto model = registry::make_deformation_model(node, context);
  node.check_all_used();
  return model;
}

/// The error of the same; "" if there is none.
inline std::string configuration_error(const std::string& deformation,
                                       const std::string& library = "") {
  try {
    configured_model(deformation, library);
  } catch (const config::Error& error) {
    return error.what();
  }
  return "";
}

}  // namespace palpate::support
