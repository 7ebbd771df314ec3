#pragma once

#include <string>

namespace palpate::bus {

/// Ensures that one process per role runs on an LCM URL of this machine (of this network namespace,
/// as for the multicast itself). Implemented by an abstract socket, which is released with the
/// process however that ends. Options of the URL are ignored.
class InstanceLock {
 public:
  /// Throws std::runtime_error naming the process that holds the lock, std::invalid_argument for an
  /// invalid URL. `role`: at most 32 characters.
  explicit InstanceLock(const std::string& url, const std::string& role = "palpated");
  ~InstanceLock();
  InstanceLock(const InstanceLock&) = delete;
  InstanceLock& operator=(const InstanceLock&) = delete;

 private:
  int socket_ = -1;
};

}  // namespace palpate::bus
