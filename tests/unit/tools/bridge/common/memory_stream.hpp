#pragma once

#include <deque>
#include <string>
#include <utility>

#include "tools/bridge/common/stream.hpp"

namespace palpate::bridge {

/// Both directions of a connection to a mock, with the time of each arrival.
struct Pipe {
  bool is_open = false;
  bool is_wanted = false;  // the client connects
  std::deque<std::pair<std::int64_t, std::uint8_t>> to_client, to_server;
};

/// The client's end of a pipe, in virtual time.
class MemoryStream final : public Stream {
 public:
  MemoryStream(Pipe& pipe, const std::int64_t& now_ns, std::string name)
      : pipe_(pipe), now_ns_(now_ns), name_(std::move(name)) {}

  void open() override { pipe_ = {}, pipe_.is_wanted = true; }
  State state() override {
    return pipe_.is_open ? State::kOpen : pipe_.is_wanted ? State::kConnecting : State::kClosed;
  }
  int read(std::uint8_t* to, int size) override {
    int count = 0;
    while (count < size && !pipe_.to_client.empty() && pipe_.to_client.front().first <= now_ns_) {
      to[count++] = pipe_.to_client.front().second;
      pipe_.to_client.pop_front();
    }
    return count;
  }
  bool write(const std::uint8_t* data, int size) override {
    if (!pipe_.is_open) return false;
    for (int i = 0; i < size; ++i) pipe_.to_server.emplace_back(now_ns_, data[i]);
    return true;
  }
  void close() override { pipe_ = {}; }
  const std::string& name() const override { return name_; }

 private:
  Pipe& pipe_;
  const std::int64_t& now_ns_;
  std::string name_;
};

}  // namespace palpate::bridge
