#include "tools/view/live_source.hpp"

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/multicast.hpp>
#include <boost/asio/ip/udp.hpp>

#include "rt/bus/authentication.hpp"
#include "rt/bus/udpm_frame.hpp"
#include "rt/bus/udpm_url.hpp"

namespace palpate::view {

namespace asio = boost::asio;
using asio::ip::udp;

struct LiveSource::Sockets {
  asio::io_context context;
  std::vector<udp::socket> all;
};

namespace {

constexpr std::size_t kLargestDatagram = 65536;
constexpr int kReceiveBuffer = 16 << 20;  // bytes; the system grants what it allows

udp::socket join(asio::io_context& context, const bus::UdpmUrl& url) {
  udp::socket socket(context);
  const asio::ip::address_v4 group = asio::ip::make_address_v4(url.address);
  const udp::endpoint endpoint(group, static_cast<std::uint16_t>(url.port));
  try {
    socket.open(udp::v4());
    socket.set_option(udp::socket::reuse_address(true));
    boost::system::error_code ignored;
    const int wanted = url.receive_buffer_size > 0 ? url.receive_buffer_size : kReceiveBuffer;
    socket.set_option(asio::socket_base::receive_buffer_size(wanted), ignored);
    // Bound to the group, not to any address, the socket receives this group only.
    socket.bind(endpoint);
    socket.set_option(asio::ip::multicast::join_group(group));
    socket.non_blocking(true);
  } catch (const boost::system::system_error& error) {
    throw std::runtime_error(bus::explain_socket_error("listen to", url, error.code().value()));
  }
  return socket;
}

}  // namespace

LiveSource::LiveSource(const std::vector<std::string>& urls)
    : sockets_(std::make_unique<Sockets>()), buffer_(kLargestDatagram) {
  std::vector<std::string> joined;
  for (const std::string& text : urls) {
    const bus::UdpmUrl url = bus::parse_udpm_url(text);
    if (std::find(joined.begin(), joined.end(), url.group()) != joined.end()) continue;
    joined.push_back(url.group());
    sockets_->all.push_back(join(sockets_->context, url));
  }
}

LiveSource::~LiveSource() = default;

void LiveSource::receive(Scene& scene, int most) {
  for (udp::socket& socket : sockets_->all) {
    for (int i = 0; i < most; ++i) {
      boost::system::error_code error;
      const std::size_t size = socket.receive(asio::buffer(buffer_), 0, error);
      if (error) break;
      handle(scene, buffer_.data(), static_cast<int>(size), bus::wall_clock_us());
    }
  }
}

void LiveSource::handle(Scene& scene, const std::uint8_t* data, int size, std::int64_t time_us) {
  ++counters_.datagrams;
  bus::UdpmFrame frame{};
  if (bus::parse_udpm_frame(data, size, frame) != bus::FrameKind::kMessage) {
    ++counters_.malformed;
    return;
  }
  const auto& channels = Scene::channels();
  if (std::find(channels.begin(), channels.end(), frame.channel) == channels.end()) {
    ++counters_.of_no_interest;
    return;
  }
  scene.accept(frame.channel, frame.payload, frame.payload_size, time_us);
}

}  // namespace palpate::view
