#pragma once

#include <string>

namespace palpate::bus {

/// Lets one process of a role at a time run on an LCM URL of this machine (of this network
/// namespace, as the multicast itself). Held by an abstract socket, which goes with the process
/// however that ends; nothing stale is left. Options of the URL make no difference.
class InstanceLock {
 public:
  /// Throws std::runtime_error that names the process which holds it, std::invalid_argument for a
  /// URL that is wrong. `role`: at most 32 characters.
  explicit InstanceLock(const std::string& url, const std::string& role = "palpated");
  ~InstanceLock();
  InstanceLock(const InstanceLock&) = delete;
  InstanceLock& operator=(const InstanceLock&) = delete;

 private:
  int socket_ = -1;
};

}  // namespace palpate::bus
