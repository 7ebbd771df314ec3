#include "tools/lab/studies/study_host.hpp"

#include <sys/utsname.h>

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

namespace palpate::studies {
namespace {

/// The value behind "key : value" or "key: value" of a file in /proc.
std::string value_in(const char* file, const std::string& key) {
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    if (line.rfind(key, 0) != 0) continue;
    const std::size_t value = line.find_first_not_of(" \t", line.find(':') + 1);
    if (value != std::string::npos) return line.substr(value);
  }
  return "unknown";
}

}  // namespace

nlohmann::json describe_host() {
  nlohmann::json host{{"processor", value_in("/proc/cpuinfo", "model name")},
                      {"cores", std::thread::hardware_concurrency()},
                      {"memory", value_in("/proc/meminfo", "MemTotal")},
                      {"kernel", "unknown"},
                      {"load", "unknown"}};
  utsname system{};
  if (uname(&system) == 0)
    host["kernel"] = std::string(system.sysname) + " " + system.release + " " + system.version;
  double load[3];
  if (getloadavg(load, 3) == 3) host["load"] = {load[0], load[1], load[2]};
  return host;
}

}  // namespace palpate::studies
