#include "tools/view/live_source.hpp"

#include <algorithm>
#include <utility>

#include "rt/bus/authentication.hpp"

namespace palpate::view {

LiveSource::LiveSource(const std::vector<std::string>& urls, bus::ChannelNames names)
    : names_(std::move(names)) {
  std::vector<std::string> joined;
  for (const std::string& text : urls) {
    const bus::UdpmUrl url = bus::parse_udpm_url(text);
    if (std::find(joined.begin(), joined.end(), url.group()) != joined.end()) continue;
    joined.push_back(url.group());
    sockets_.emplace_back().open(url);
  }
}

void LiveSource::receive(Scene& scene, int most) {
  for (bus::UdpmSocket& socket : sockets_) {
    for (int i = 0; i < most; ++i) {
      const int size = socket.receive(counters_);
      if (size < 0) break;
      handle(scene, socket.data(), size, bus::wall_clock_us());
    }
  }
}

void LiveSource::handle(Scene& scene, const std::uint8_t* data, int size, std::int64_t time_us) {
  bus::UdpmFrame frame{};
  if (!bus::parse_udpm_frame(data, size, counters_, frame)) return;
  const auto channel = bus::own_name(names_, frame.channel);
  if (listener_) listener_(channel, frame.payload, frame.payload_size, time_us);
  if (!scene.accept(channel, frame.payload, frame.payload_size, time_us)) ++counters_.unsubscribed;
}

}  // namespace palpate::view
