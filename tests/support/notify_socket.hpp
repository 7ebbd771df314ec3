#pragma once

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstddef>
#include <cstring>
#include <string>
#include <vector>

namespace palpate::support {

/// Stand-in for systemd: an abstract socket that receives the services' notifications.
class NotifySocket {
 public:
  NotifySocket() {
    static int count = 0;
    name_ = "@palpate_test_" + std::to_string(getpid()) + "_" + std::to_string(count++);
    file_ = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::memcpy(address.sun_path + 1, name_.data() + 1, name_.size() - 1);
    const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + name_.size());
    if (bind(file_, reinterpret_cast<const sockaddr*>(&address), size) != 0) name_.clear();
  }
  ~NotifySocket() { close(file_); }
  NotifySocket(const NotifySocket&) = delete;
  NotifySocket& operator=(const NotifySocket&) = delete;

  /// Value of NOTIFY_SOCKET.
  const std::string& name() const { return name_; }

  /// All received notifications, one text per message.
  std::vector<std::string> take() {
    std::vector<std::string> texts;
    char buffer[1000];
    for (ssize_t size; (size = recv(file_, buffer, sizeof(buffer), 0)) >= 0;)
      texts.emplace_back(buffer, static_cast<std::size_t>(size));
    return texts;
  }

 private:
  std::string name_;
  int file_ = -1;
};

}  // namespace palpate::support
