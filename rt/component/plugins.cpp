#include "rt/component/plugins.hpp"

#include <dlfcn.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <set>

#include "rt/component/built_in_names.hpp"
#include "rt/component/plugin_guards.hpp"
#include "rt/component/registry.hpp"

namespace palpate::component {
namespace {

constexpr int kLongestName = 31;  // that a message holds

[[noreturn]] void refuse(const config::Node& item, const std::string& path,
                         const std::string& what) {
  item.fail("library", path + ": " + what);
}

/// dlerror() tells the path as well, or some library that this one needs.
std::string why_not_loaded(const std::string& path) {
  const char* error = dlerror();
  std::string text = error == nullptr ? "unknown error" : error;
  if (text.rfind(path + ": ", 0) == 0) text.erase(0, path.size() + 2);
  return text;
}

/// What differs, in words; empty where nothing does. Sizes beyond those of a short structure are
/// not looked at.
std::string difference(const PluginAbi& theirs) {
  const PluginAbi& ours = kPluginAbi;
  if (theirs.magic != ours.magic) return "its palpate_plugin_abi is none";
  std::string text;
  const auto compare = [&text](const char* what, const auto& there, const auto& here) {
    if (there == here) return;
    text += std::string(text.empty() ? "" : ", ") + what + " " + std::to_string(there) + ", here " +
            std::to_string(here);
  };
  compare("plug-in interface", theirs.interface, ours.interface);
  if (!text.empty()) return text;
  compare("size of the description", theirs.size, ours.size);
  if (!text.empty()) return text;
  const std::string version(theirs.version, strnlen(theirs.version, sizeof theirs.version));
  if (version != ours.version) text = "palpate " + version + ", here " + ours.version;
  compare("C++ ABI", theirs.compiler, ours.compiler);
  compare("kind of std::string", theirs.strings, ours.strings);
  compare("Eigen", theirs.eigen, ours.eigen);
  compare("EIGEN_MAX_ALIGN_BYTES", theirs.alignment, ours.alignment);
  compare("size of sensing::Signals", theirs.signals, ours.signals);
  compare("size of sensing::ContactSet", theirs.contacts, ours.contacts);
  compare("size of control::LawInputs", theirs.inputs, ours.inputs);
  compare("size of control::LawOutput", theirs.outputs, ours.outputs);
  compare("size of PluginCell", theirs.cell, ours.cell);
  compare("size of elasticity::Body", theirs.model, ours.model);
  return text;
}

/// Of names of components and keys.
bool is_name(const std::string& text) {
  const auto is_word = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
  };
  return !text.empty() && text.size() <= kLongestName && text[0] >= 'a' && text[0] <= 'z' &&
         std::all_of(text.begin(), text.end(), is_word);
}

std::string complaint(const Parameter& parameter) {
  static const std::set<std::string> kTaken = {"arm",      "command", "component", "fallback",
                                               "finger",   "law",     "moves",     "name",
                                               "provider", "sources"};
  const std::string key = "key '" + parameter.key + "' ";
  if (!is_name(parameter.key)) return key + "is no name of a-z, 0-9 and _, at most 31 characters";
  if (kTaken.count(parameter.key) != 0) return key + "is palpate's own";
  const auto within = [&parameter](double value) {
    return value >= parameter.lower && value <= parameter.upper;
  };
  bool good = true;
  switch (parameter.kind) {
    case Parameter::Kind::kNumber:
      good = std::holds_alternative<double>(parameter.otherwise) &&
             (parameter.required || within(std::get<double>(parameter.otherwise)));
      break;
    case Parameter::Kind::kInteger:
      good = std::holds_alternative<int>(parameter.otherwise) &&
             (parameter.required || within(std::get<int>(parameter.otherwise)));
      break;
    case Parameter::Kind::kFlag:
      good = std::holds_alternative<bool>(parameter.otherwise);
      break;
    case Parameter::Kind::kChoice: {
      const auto* text = std::get_if<std::string>(&parameter.otherwise);
      const auto& allowed = parameter.allowed;
      good =
          text != nullptr && !allowed.empty() &&
          (parameter.required || std::find(allowed.begin(), allowed.end(), *text) != allowed.end());
      break;
    }
    case Parameter::Kind::kNumbers: {
      const auto* list = std::get_if<std::vector<double>>(&parameter.otherwise);
      good = list != nullptr && static_cast<int>(list->size()) == parameter.count &&
             (parameter.required || std::all_of(list->begin(), list->end(), within));
      break;
    }
  }
  return good ? "" : key + "has a default that it does not allow";
}

/// "" or what is wrong with one of `entries`, whose names must differ from those of `before`.
template <class Component, std::size_t kCount>
std::string complaint(const char* slot, const std::vector<PluginEntry<Component>>& entries,
                      const std::array<const char*, kCount>& built_in,
                      const std::vector<PluginEntry<Component>>& before) {
  std::set<std::string> names;
  for (const auto& other : before) names.insert(other.name);
  for (const PluginEntry<Component>& entry : entries) {
    const std::string which = std::string(slot) + " '" + entry.name + "' ";
    if (!is_name(entry.name)) return which + "is no name of a-z, 0-9 and _, at most 31 characters";
    if (std::find(built_in.begin(), built_in.end(), entry.name) != built_in.end())
      return which + "has the name of a built-in one";
    if (!names.insert(entry.name).second) return which + "is there twice";
    if (!entry.make) return which + "has no function that makes it";
    std::set<std::string> keys;
    for (const Parameter& parameter : entry.parameters) {
      const std::string wrong = complaint(parameter);
      if (!wrong.empty()) return which + wrong;
      if (!keys.insert(parameter.key).second)
        return which + "has the key '" + parameter.key + "' twice";
    }
  }
  return "";
}

template <class Entry>
void append(std::vector<Entry>& into, std::vector<Entry>& from) {
  into.insert(into.end(), std::make_move_iterator(from.begin()),
              std::make_move_iterator(from.end()));
}

/// Getters with a default count a key as known where it is absent.
ParameterValue read(const config::Node& node, const Parameter& parameter) {
  const std::string& key = parameter.key;
  const config::Range range{parameter.lower, parameter.upper};
  const bool given = parameter.required || node.has(key);
  switch (parameter.kind) {
    case Parameter::Kind::kNumber:
      return given ? node.number(key, range)
                   : node.number(key, range, std::get<double>(parameter.otherwise));
    case Parameter::Kind::kInteger:
      return given ? node.integer(key, range)
                   : node.integer(key, range, std::get<int>(parameter.otherwise));
    case Parameter::Kind::kFlag:
      if (given && !node.has(key)) node.fail(key, "is missing; allowed: true, false");
      return node.flag(key, std::get<bool>(parameter.otherwise));
    case Parameter::Kind::kChoice:
      return given
                 ? node.choice(key, parameter.allowed)
                 : node.choice(key, parameter.allowed, std::get<std::string>(parameter.otherwise));
    case Parameter::Kind::kNumbers:
      break;
  }
  return given ? ParameterValue(node.numbers(key, parameter.count, range)) : parameter.otherwise;
}

template <class Component>
std::unique_ptr<Component> make(const PluginEntry<Component>& entry, const config::Node& node,
                                const char* key, const PluginCell& cell) {
  Parameters parameters;
  for (const Parameter& parameter : entry.parameters) {
    try {
      parameters.put(parameter.key, read(node, parameter));
    } catch (const config::Error& error) {
      throw config::Error(std::string(error.what()) + " (" + entry.name + ": " +
                          parameter.description + ")");
    }
  }
  std::unique_ptr<Component> made;
  try {
    made = entry.make(parameters, cell);
  } catch (const config::Error&) {
    throw;
  } catch (const std::exception& error) {
    node.fail(key, entry.name + ": " + error.what());
  } catch (...) {
    node.fail(key, entry.name + ": the plug-in threw something that is no std::exception");
  }
  if (!made) node.fail(key, entry.name + ": the plug-in made nothing");
  return made;
}

/// Calls what may throw std::invalid_argument or anything else of the plug-in's.
template <class Call>
auto guarded(const config::Node& node, const char* key, const std::string& name, Call call) {
  try {
    return call();
  } catch (const std::exception& error) {
    node.fail(key, name + ": " + error.what());
  } catch (...) {
    node.fail(key, name + ": the plug-in threw something that is no std::exception");
  }
}

PluginCell cell_of(const Context& context, const Frames& frames) {
  PluginCell cell;
  cell.period = context.period;
  cell.deterministic = context.deterministic;
  cell.X_WO = frames.X_WO;
  cell.X_ES = frames.X_ES;
  cell.X_EI = frames.X_EI;
  cell.X_EG = frames.X_EG;
  cell.gravity_W = frames.gravity_W;
  if (context.object != nullptr) {
    cell.body = &context.object->body;
    cell.surface = &context.object->surface;
  }
  return cell;
}

}  // namespace

std::shared_ptr<const Plugins> Plugins::load(const config::Node& root) {
  auto plugins = std::make_shared<Plugins>();
  for (const config::Node& item :
       root.list({"plugins", "", "libraries with components of your own (tools/examples)"}))
    plugins->add(item.path({"library", "", "shared library, relative to this file"}), item);
  return plugins;
}

void Plugins::add(const std::string& path, const config::Node& item) {
  // Without a slash it would be looked for elsewhere.
  const std::string place = path.find('/') == std::string::npos ? "./" + path : path;
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(place, ignored))
    refuse(item, path, "there is no such file");
  void* const library = dlopen(place.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
  if (library == nullptr)
    refuse(item, path, "cannot be loaded as a plug-in: " + why_not_loaded(place));
  const auto* abi = static_cast<const PluginAbi*>(dlsym(library, "palpate_plugin_abi"));
  using Register = void (*)(PluginRegistrar&);
  const auto enter = reinterpret_cast<Register>(dlsym(library, "palpate_plugin_register"));
  if (abi == nullptr || enter == nullptr)
    refuse(item, path,
           std::string("is no plug-in of palpate: it has no ") +
               (abi == nullptr ? "palpate_plugin_abi" : "palpate_plugin_register") +
               "; see PALPATE_PLUGIN in rt/component/plugin.hpp");
  const std::string differs = difference(*abi);
  if (!differs.empty())
    refuse(item, path, "was built for another palpate (" + differs + "); build it anew");

  PluginRegistrar incoming;
  try {
    enter(incoming);
  } catch (const std::exception& error) {
    refuse(item, path, std::string("its registration failed: ") + error.what());
  } catch (...) {
    refuse(item, path, "its registration threw something that is no std::exception");
  }
  PluginRegistrar& all = components_;
  for (const std::string& wrong :
       {complaint("sensor model", incoming.sensor_models, kSensorModels, all.sensor_models),
        complaint("force transformer", incoming.force_transformers, kForceTransformers,
                  all.force_transformers),
        complaint("Jacobian provider", incoming.jacobian_providers, kJacobianProviders,
                  all.jacobian_providers),
        complaint("control law", incoming.control_laws, kControlLaws, all.control_laws)})
    if (!wrong.empty()) refuse(item, path, wrong);
  append(all.sensor_models, incoming.sensor_models);
  append(all.force_transformers, incoming.force_transformers);
  append(all.jacobian_providers, incoming.jacobian_providers);
  append(all.control_laws, incoming.control_laws);
}

const PluginRegistrar& plugins_of(const Context& context) {
  static const PluginRegistrar kNone;
  return context.plugins ? context.plugins->components() : kNone;
}

std::unique_ptr<sensing::SensorModel> make_plugin(const PluginEntry<PluginSensorModel>& entry,
                                                  const config::Node& node,
                                                  const Context& context) {
  const int arm = read_arm(node, context);
  PluginCell cell = cell_of(context, arm == 1 ? *context.second_frames : context.frames);
  cell.arm = arm;
  if (entry.sensor == SensorKind::kFinger) cell.finger = node.integer("finger", {0, 4}, 0);
  return guard(make(entry, node, "component", cell));
}

std::unique_ptr<contact::ForceTransformer> make_plugin(
    const PluginEntry<PluginForceTransformer>& entry, const config::Node& node,
    const Context& context) {
  auto made = make(entry, node, "component", cell_of(context, context.frames));
  return guarded(node, "component", entry.name,
                 [&] { return guard(std::move(made), context.object->body.mesh.node_count()); });
}

std::unique_ptr<control::JacobianProvider> make_plugin(
    const PluginEntry<PluginJacobianProvider>& entry, const config::Node& node,
    const Context& context) {
  return guard(make(entry, node, "provider", cell_of(context, context.frames)));
}

std::unique_ptr<control::ControlLaw> make_plugin(const PluginEntry<PluginControlLaw>& entry,
                                                 const config::Node& node, const Context& context) {
  return guard(make(entry, node, "law", cell_of(context, context.frames)));
}

}  // namespace palpate::component
