#include <lcm/lcm.h>

#include <stdexcept>

#include "rt/bus/message_bus.hpp"
#include "rt/bus/telemetry_publisher.hpp"
#include "rt/bus/udpm_frame.hpp"
#include "rt/bus/udpm_receiver.hpp"

namespace palpate::bus {
namespace {

/// Publishes through liblcm, which starts its own receiver only for a subscription, and none is
/// made here.
class LcmSender {
 public:
  explicit LcmSender(const UdpmUrl& url) : lcm_(lcm_create(url.text().c_str())) {
    if (!lcm_)
      throw std::runtime_error("liblcm cannot open " + url.text() + "; its message is above");
  }

  bool publish(const char* channel, const void* data, int size) noexcept {
    if (!fits_one_datagram(channel, size)) return false;
    return lcm_publish(lcm_.get(), channel, data, static_cast<unsigned>(size)) == 0;
  }

 private:
  struct Destroy {
    void operator()(lcm_t* lcm) const noexcept { lcm_destroy(lcm); }
  };
  std::unique_ptr<lcm_t, Destroy> lcm_;
};

/// liblcm finds a missing route as well, but reports it on stderr and returns nothing to explain.
const UdpmUrl& with_route(const UdpmUrl& url) {
  require_route(url);
  return url;
}

class LcmBus final : public MessageBus {
 public:
  explicit LcmBus(const UdpmUrl& url)
      : url_(with_route(url)), receiver_(datagrams_), sender_(url) {}

  Subscription& subscribe(const std::string& channel, int encoded_size, std::int64_t fingerprint,
                          int depth) override {
    return listed(receiver_.subscribe(channel, encoded_size, fingerprint, depth));
  }
  void set_receiver_priority(int fifo_priority) noexcept override {
    receiver_.set_priority(fifo_priority);
  }
  void start() override { receiver_.start(url_); }
  void start_without_thread() override { receiver_.open(url_); }
  bool receive(std::int64_t timeout_ns) noexcept override { return receiver_.receive(timeout_ns); }
  void stop() noexcept override { receiver_.stop(); }

  bool publish(const char* channel, const void* data, int size) noexcept override {
    return sender_.publish(channel, data, size);
  }
  void start_publisher(int depth, int largest) override {
    // liblcm locks while it sends: a separate instance for the publisher never delays a command
    publisher_ = std::make_unique<TelemetryPublisher>(
        [sender = std::make_shared<LcmSender>(url_)](const char* channel, const void* data,
                                                     int size) {
          return sender->publish(channel, data, size);
        },
        depth, largest);
  }
  Outlet* outlet() noexcept override { return publisher_.get(); }
  std::int64_t unpublished() const noexcept override { return publisher_ ? publisher_->lost() : 0; }

 private:
  UdpmUrl url_;
  UdpmReceiver receiver_;
  LcmSender sender_;
  std::unique_ptr<TelemetryPublisher> publisher_;
};

}  // namespace

std::unique_ptr<MessageBus> make_lcm_bus(const std::string& url) {
  return std::make_unique<LcmBus>(parse_udpm_url(url));
}

}  // namespace palpate::bus
