#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace palpate::serve {

/// A connected page, as the content knows it.
struct Client {
  virtual ~Client() = default;

  std::function<void(std::string)> send_text;
  bool may_control = false;
  int wrong_tokens = 0;
  std::int64_t generation = 0;    // of the content that it has
  std::int64_t acknowledged = 0;  // frame
};

/// A client that presents the wrong token so often is disconnected.
inline constexpr int kMostWrongTokens = 3;

/// Data that may be sent to a page at once.
struct Delivery {
  std::vector<std::string> texts;
  std::vector<std::shared_ptr<const std::string>> parcels;  // the frame last
  std::int64_t frame = 0;  // its number; 0: not a frame, so that pages need not acknowledge it
};

/// What a server's pages show, and what becomes of their requests. Independent of sockets. For one
/// thread. `now_us`: wall clock.
class Content {
 public:
  virtual ~Content() = default;

  /// Subprotocols of WebSocket that clients may ask for; empty for those of our own page.
  virtual std::vector<std::string> protocols() const { return {}; }
  /// What is to be known of a page that connects, which the functions below receive again.
  virtual std::shared_ptr<Client> make_client() const { return std::make_shared<Client>(); }
  /// Receives, or plays on.
  virtual void advance(std::int64_t /*now_us*/) {}
  /// Called before deliver() for all clients.
  virtual void prepare(std::int64_t /*now_us*/) {}
  /// First message to a new page.
  virtual std::string greeting(std::int64_t now_us) const = 0;
  /// New data for the client.
  virtual Delivery deliver(Client& client, std::int64_t now_us) = 0;
  /// Handles a page's message. False: disconnect the page.
  virtual bool receive(const std::shared_ptr<Client>& client, const std::string& text,
                       std::int64_t now_us) = 0;
};

}  // namespace palpate::serve
