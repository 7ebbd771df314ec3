#include "tools/view/foxglove_content.hpp"

#include <nlohmann/json.hpp>

namespace palpate::view {
namespace {

using nlohmann::json;

constexpr char kMessageData = 1;  // opcode

struct Subscription {
  std::size_t topic = 0;
  std::int64_t sent = 0;  // number of the last message sent
};

struct Subscriber : serve::Client {
  std::size_t advertised = 0;                           // topics that it knows, the first ones
  std::map<std::uint32_t, Subscription> subscriptions;  // by the client's number
};

/// Names of channels are bytes from the network.
std::string dump(const json& message) {
  return message.dump(-1, ' ', false, json::error_handler_t::replace);
}

template <class Number>
void append(Number value, std::string& bytes) {  // little-endian
  for (std::size_t i = 0; i < sizeof(value); ++i)
    bytes += static_cast<char>(static_cast<std::uint64_t>(value) >> (8 * i));
}

std::string message_data(std::uint32_t subscription, const FoxgloveTopic& topic) {
  std::string bytes;
  bytes.reserve(13 + topic.json.size());
  bytes += kMessageData;
  append(subscription, bytes);
  append(static_cast<std::uint64_t>(topic.time_us) * 1000, bytes);
  return bytes + topic.json;
}

/// A member that is an unsigned number of 32 bits; throws json::exception otherwise.
std::uint32_t number(const json& value) {
  const auto wide = value.get<std::int64_t>();
  if (!value.is_number_integer() || wide < 0 || wide > UINT32_MAX)
    throw json::other_error::create(500, "a number from 0 to 4294967295 is expected", nullptr);
  return static_cast<std::uint32_t>(wide);
}

}  // namespace

std::vector<std::string> FoxgloveContent::protocols() const { return {"foxglove.websocket.v1"}; }

std::shared_ptr<serve::Client> FoxgloveContent::make_client() const {
  return std::make_shared<Subscriber>();
}

void FoxgloveContent::prepare(std::int64_t) { topics_.follow(scene_); }

std::string FoxgloveContent::greeting(std::int64_t now_us) const {
  return dump({{"op", "serverInfo"},
               {"name", std::string("palpate-view ") + PALPATE_VERSION},
               {"capabilities", json::array()},
               {"supportedEncodings", json::array()},
               {"metadata", json::object()},
               {"sessionId", std::to_string(now_us)}});
}

serve::Delivery FoxgloveContent::deliver(serve::Client& client, std::int64_t) {
  auto& subscriber = static_cast<Subscriber&>(client);
  serve::Delivery delivery;
  json channels = json::array();
  for (; subscriber.advertised < topics_.size(); ++subscriber.advertised) {
    const FoxgloveTopic& topic = topics_.at(subscriber.advertised);
    channels.push_back({{"id", subscriber.advertised},
                        {"topic", topic.name},
                        {"encoding", "json"},
                        {"schemaName", topic.schema_name},
                        {"schema", topic.schema},
                        {"schemaEncoding", "jsonschema"}});
  }
  if (!channels.empty())
    delivery.texts.push_back(dump({{"op", "advertise"}, {"channels", channels}}));
  for (auto& [id, subscription] : subscriber.subscriptions) {
    const FoxgloveTopic& topic = topics_.at(subscription.topic);
    if (topic.number == subscription.sent || topic.json.empty()) continue;
    subscription.sent = topic.number;
    delivery.parcels.push_back(std::make_shared<const std::string>(message_data(id, topic)));
  }
  return delivery;
}

bool FoxgloveContent::receive(const std::shared_ptr<serve::Client>& client, const std::string& text,
                              std::int64_t) {
  auto& subscriber = static_cast<Subscriber&>(*client);
  const auto complain = [&](const std::string& problem) {
    client->send_text(dump({{"op", "status"}, {"level", 2}, {"message", problem}}));
  };
  try {
    const json request = json::parse(text);
    const auto op = request.at("op").get<std::string>();
    if (op == "subscribe") {
      for (const json& wanted : request.at("subscriptions")) {
        const std::uint32_t topic = number(wanted.at("channelId"));
        if (topic >= subscriber.advertised) {
          complain("channel " + std::to_string(topic) + " has not been advertised");
          continue;
        }
        if (subscriber.subscriptions.size() >= kMostSubscriptions) return false;
        subscriber.subscriptions[number(wanted.at("id"))] = {topic, 0};
      }
    } else if (op == "unsubscribe") {
      for (const json& id : request.at("subscriptionIds"))
        subscriber.subscriptions.erase(number(id));
    } else {
      complain("palpate-view only sends: " + op + " is not supported");
    }
  } catch (const json::exception& error) {
    complain(error.what());
  }
  return true;
}

}  // namespace palpate::view
