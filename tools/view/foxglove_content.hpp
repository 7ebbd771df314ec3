#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "tools/serve/content.hpp"
#include "tools/view/foxglove_topics.hpp"

namespace palpate::view {

/// Delivers topics to Foxglove by its WebSocket protocol (foxglove.websocket.v1): JSON messages
/// with their JSON schemas, of each subscribed topic the last one at every delivery. Clients only
/// read: none of the protocol's optional capabilities is offered.
class FoxgloveContent : public serve::Content {
 public:
  static constexpr std::size_t kMostSubscriptions = 1'000;  // of one client

  /// `topics` and `scene` must outlive it.
  FoxgloveContent(FoxgloveTopics& topics, const Scene& scene) : topics_(topics), scene_(scene) {}

  std::vector<std::string> protocols() const override;
  std::shared_ptr<serve::Client> make_client() const override;
  void prepare(std::int64_t now_us) override;
  std::string greeting(std::int64_t now_us) const override;
  serve::Delivery deliver(serve::Client& client, std::int64_t now_us) override;
  bool receive(const std::shared_ptr<serve::Client>& client, const std::string& text,
               std::int64_t now_us) override;

 private:
  FoxgloveTopics& topics_;
  const Scene& scene_;
};

}  // namespace palpate::view
