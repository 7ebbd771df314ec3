#include "stream.hpp"

#include <netdb.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <stdexcept>
#include <vector>

namespace palpate::bridge {
namespace {

constexpr std::size_t kMostPending = 16384;  // bytes that the peer may leave untaken

class TcpStream final : public Stream {
 public:
  TcpStream(const std::string& host, int port)
      : name_(host + ":" + std::to_string(port)), address_(ipv4_address(host, port)) {}
  ~TcpStream() override { TcpStream::close(); }
  TcpStream(const TcpStream&) = delete;
  TcpStream& operator=(const TcpStream&) = delete;

  void open() override {
    close();
    socket_ = ::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    if (socket_ < 0) return;
    const int yes = 1;
    setsockopt(socket_, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof(yes));
    const auto* address = reinterpret_cast<const sockaddr*>(&address_);
    if (::connect(socket_, address, sizeof(address_)) == 0)
      state_ = State::kOpen;
    else if (errno == EINPROGRESS)
      state_ = State::kConnecting;
    else
      close();
  }

  State state() override {
    if (state_ == State::kConnecting) {
      pollfd one{socket_, POLLOUT, 0};
      if (::poll(&one, 1, 0) > 0) {
        int error = 0;
        socklen_t size = sizeof(error);
        getsockopt(socket_, SOL_SOCKET, SO_ERROR, &error, &size);
        if (error == 0)
          state_ = State::kOpen;
        else
          close();
      }
    }
    return state_;
  }

  int read(std::uint8_t* to, int size) override {
    if (state_ != State::kOpen || !flush()) return 0;
    const ssize_t count = ::recv(socket_, to, static_cast<std::size_t>(size), 0);
    if (count > 0) return static_cast<int>(count);
    if (count == 0 || !is_patience()) close();
    return 0;
  }

  bool write(const std::uint8_t* data, int size) override {
    if (state_ != State::kOpen) return false;
    pending_.insert(pending_.end(), data, data + size);
    if (pending_.size() > kMostPending) close();
    return flush();
  }

  void close() override {
    if (socket_ >= 0) ::close(socket_);
    socket_ = -1;
    state_ = State::kClosed;
    pending_.clear();
  }

  const std::string& name() const override { return name_; }

 private:
  static bool is_patience() { return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR; }

  bool flush() {
    if (state_ != State::kOpen) return false;
    while (!pending_.empty()) {
      const ssize_t count = ::send(socket_, pending_.data(), pending_.size(), MSG_NOSIGNAL);
      if (count < 0) {
        if (is_patience()) return true;
        close();
        return false;
      }
      pending_.erase(pending_.begin(), pending_.begin() + count);
    }
    return true;
  }

  std::string name_;
  sockaddr_in address_;
  int socket_ = -1;
  State state_ = State::kClosed;
  std::vector<std::uint8_t> pending_;
};

}  // namespace

sockaddr_in ipv4_address(const std::string& host, int port) {
  addrinfo hints{};
  hints.ai_family = AF_INET;
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (const int error = getaddrinfo(host.c_str(), nullptr, &hints, &found); error != 0)
    throw std::runtime_error(host + ": " + gai_strerror(error));
  sockaddr_in address = *reinterpret_cast<const sockaddr_in*>(found->ai_addr);
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  freeaddrinfo(found);
  return address;
}

std::unique_ptr<Stream> make_tcp_stream(const std::string& host, int port) {
  return std::make_unique<TcpStream>(host, port);
}

}  // namespace palpate::bridge
