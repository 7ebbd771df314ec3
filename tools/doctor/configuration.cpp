#include "rt/daemon/daemon.hpp"
#include "tools/doctor/checks.hpp"

namespace palpate::doctor {

Needs needs_of(const config::Node& root) {
  const daemon::Settings settings = daemon::read_settings(root);
  Needs needs;
  needs.control = bus::parse_udpm_url(settings.control_url);
  needs.housekeeping = bus::parse_udpm_url(settings.housekeeping_url);
  needs.fifo_priority = settings.loop.fifo_priority;
  needs.cpu = settings.loop.cpu;
  needs.lock_memory = settings.loop.lock_memory;
  if (!settings.record.folder.empty()) needs.record_folder = settings.record.folder;
  return needs;
}

Findings check_configuration(const std::string& path, const std::vector<std::string>& overrides) {
  try {
    const config::Node root = config::Node::load_file(path, overrides);
    needs_of(root);
    const auto hub = bus::make_memory_hub();
    const auto bus = bus::make_memory_bus(hub);
    daemon::Daemon daemon(root, *bus, *bus, daemon::Mode::kDeterministic, 1);
    const registry::Object& object = daemon.pipeline().object();
    std::string text = path + ": " + std::to_string(object.body.mesh.node_count()) + " nodes, " +
                       std::to_string(object.body.mesh.element_count()) +
                       " elements, every file that it names can be read";
    Findings findings{ok("configuration", text)};
    for (const std::string& remark : daemon.pipeline().remarks()) {
      findings.push_back(
          warn("configuration", remark, "palpated says so as well when it starts", ""));
    }
    return findings;
  } catch (const std::exception& error) {
    return {fail("configuration", error.what(), "palpated does not start with it",
                 "correct the named key; rt/config/examples show every key")};
  }
}

}  // namespace palpate::doctor
