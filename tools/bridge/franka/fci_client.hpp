#pragma once

#include <deque>
#include <memory>
#include <optional>

#include "datagrams.hpp"
#include "messages.hpp"
#include "tools/bridge/common/stream.hpp"

namespace palpate::franka_bridge {

/// Connects to an arm's FCI, agrees on version 10, and receives its states, of which it answers
/// each; begins again after every failure. Never waits.
class FciClient {
 public:
  /// Of the arm to an earlier request.
  struct Answer {
    std::uint32_t number = 0;  // of the request
    Request request = Request::kMove;
    std::uint8_t status = 0;  // 0: done
  };
  struct Counts {
    std::int64_t lost = 0;       // states that have never come
    std::int64_t overtaken = 0;  // states older than one before
    std::int64_t malformed = 0;  // datagrams of another size
  };

  FciClient(std::unique_ptr<bridge::Stream> stream, std::unique_ptr<Datagrams> datagrams);

  /// Once per cycle: continues to connect, and receives. `now_ns`: any steady clock.
  void poll(std::int64_t now_ns);
  /// The next state, valid until the next call; nullptr if there is none.
  const RobotState* take();
  std::optional<Answer> take_answer();
  void wait(std::int64_t until_ns) { datagrams_->wait(until_ns); }

  /// Whether states may come, and requests and commands be sent.
  bool is_running() const { return phase_ == Phase::kRunning; }
  /// kMove or kAutomaticErrorRecovery. Its number.
  std::uint32_t request(Request kind);
  /// Answers the state that has been taken last: see write_command.
  void command(const Seven& dq, bool is_last);

  const Counts& counts() const { return counts_; }
  /// What has happened, for the user; empty if there is nothing new.
  std::string next_remark();

 private:
  enum class Phase { kWaiting, kConnecting, kVersion, kRunning };

  void send(const std::vector<std::uint8_t>& request);
  void handle(const Header& header, const std::uint8_t* payload, int size);
  void remark(const std::string& text);
  /// Closes the connection, and connects again later.
  void fail(const std::string& why);

  std::unique_ptr<bridge::Stream> stream_;
  std::unique_ptr<Datagrams> datagrams_;
  Phase phase_ = Phase::kWaiting;
  std::int64_t now_ns_ = 0, deadline_ns_ = 0;
  std::uint32_t number_ = 0;  // of the next request
  std::vector<std::uint8_t> received_;
  int end_ = 0;  // of received_
  std::deque<Answer> answers_;
  RobotState state_;
  bool has_state_ = false;  // since the connection
  std::array<std::uint8_t, kStateSize> datagram_{};
  Counts counts_;
  std::deque<std::string> remarks_;
  std::string last_remark_;
};

}  // namespace palpate::franka_bridge
