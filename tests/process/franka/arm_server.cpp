// franka_mock_arm: the mock of a Franka arm of the unit tests behind sockets, in real time. Prints
// its port. Obeys lines on standard input:
//   user_stop on|off        silent on|off       collide         release         drop
//   errors NUMBER           wrench NUMBER ... (six)             noise NEWTONS, of the wrench
//   state                   prints "state MODE SPEED MOTIONS ENDED COMMANDS REFLEXES Q ...;
//   VIOLATION"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sched.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <fstream>
#include <random>
#include <sstream>
#include <thread>

#include "tests/unit/tools/bridge/franka/mock_arm.hpp"

namespace {

using palpate::franka_bridge::MockArm;

sockaddr_in address_of(const char* text, int port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = inet_addr(text);
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  return address;
}

/// Moves bytes between the mock's network and sockets.
class Sockets {
 public:
  Sockets(const char* host, int wanted_port)
      : listener_(::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK, 0)),
        datagrams_(::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK, 0)) {
    sockaddr_in address = address_of(host, wanted_port), states = address_of(host, 0);
    socklen_t size = sizeof(address);
    const int yes = 1;
    ::setsockopt(listener_, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
    ::bind(datagrams_, reinterpret_cast<sockaddr*>(&states), size);
    ::bind(listener_, reinterpret_cast<sockaddr*>(&address), size);
    ::getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size);
    ::listen(listener_, 1);
    port = ntohs(address.sin_port);
  }

  /// One client at a time: another one's connection waits.
  void receive(MockArm& arm) {
    MockArm::Network& network = arm.network();
    if (peer_ < 0) {
      peer_ = ::accept4(listener_, nullptr, nullptr, SOCK_NONBLOCK);
      if (peer_ < 0) return;
      const int yes = 1;
      ::setsockopt(peer_, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof(yes));
      network.tcp = {};
      network.tcp.is_wanted = true;
    }
    std::uint8_t bytes[4096];
    ssize_t count = 0;
    while ((count = ::recv(peer_, bytes, sizeof(bytes), 0)) > 0)
      for (ssize_t i = 0; i < count; ++i) network.tcp.to_server.emplace_back(0, bytes[i]);
    if (count == 0) close(arm);
    while ((count = ::recv(datagrams_, bytes, sizeof(bytes), 0)) >= 0)
      network.to_server.push_back({0, std::vector<std::uint8_t>(bytes, bytes + count)});
  }

  void send(MockArm& arm, std::int64_t now_ns) {
    MockArm::Network& network = arm.network();
    auto& bytes = network.tcp.to_client;
    while (!bytes.empty() && bytes.front().first <= now_ns) {
      text_.push_back(bytes.front().second);
      bytes.pop_front();
    }
    if (peer_ >= 0 && !text_.empty()) ::send(peer_, text_.data(), text_.size(), MSG_NOSIGNAL);
    text_.clear();
    const sockaddr_in to = address_of("127.0.0.1", network.client_port);
    for (const MockArm::Datagram& state : network.to_client)
      ::sendto(datagrams_, state.bytes.data(), state.bytes.size(), 0,
               reinterpret_cast<const sockaddr*>(&to), sizeof(to));
    network.to_client.clear();
  }

  void close(MockArm& arm) {
    if (peer_ >= 0) ::close(peer_);
    peer_ = -1;
    arm.network().tcp = {};
  }

  int port = 0;

 private:
  int listener_, datagrams_, peer_ = -1;
  std::vector<std::uint8_t> text_;
};

/// Of the wrench.
struct Reading {
  std::array<double, 6> mean{};  // N, N m
  double noise = 0;              // N, N m
};

void obey(const std::string& line, MockArm& arm, Sockets& sockets, Reading& wrench) {
  std::istringstream words(line);
  std::string word, state;
  words >> word;
  if (word == "user_stop") {
    words >> state;
    arm.is_user_stopped = state == "on";
    if (!arm.is_user_stopped) arm.release();
  } else if (word == "silent") {
    words >> state;
    arm.is_absent = state == "on";
  } else if (word == "collide") {
    arm.collide();
  } else if (word == "release") {
    arm.release();
  } else if (word == "drop") {
    sockets.close(arm);
  } else if (word == "errors") {
    std::size_t error = 0;
    words >> error;
    arm.extra_errors = {};
    arm.extra_errors.at(error) = true;
  } else if (word == "wrench") {
    for (double& number : wrench.mean) words >> number;
  } else if (word == "noise") {
    words >> wrench.noise;
  } else if (word == "state") {
    std::printf("state %d %.6f %d %d %d %d", static_cast<int>(arm.mode()), arm.speed(),
                arm.motions(), arm.ended(), arm.commands(), arm.reflexes());
    for (const double q : arm.q()) std::printf(" %.6f", q);
    std::printf("; %s\n", arm.violation().c_str());
    std::fflush(stdout);
  } else {
    std::fprintf(stderr, "%s: not known\n", line.c_str());
  }
}

}  // namespace

int main(int argc, char** argv) {
  using Clock = std::chrono::steady_clock;
  palpate::driver::Joints q(palpate::franka_bridge::kJoints);
  if (argc != 4 + q.size()) {
    std::fprintf(stderr, "usage: franka_mock_arm ADDRESS PORT URDF Q1 ... Q7\n");
    return 64;
  }
  for (int i = 0; i < q.size(); ++i) q[i] = std::stod(argv[4 + i]);
  MockArm arm(q);
  std::stringstream urdf;
  urdf << std::ifstream(argv[3]).rdbuf();
  arm.urdf = urdf.str();
  Sockets sockets(argv[1], std::stoi(argv[2]));
  std::printf("port %d\n", sockets.port);
  std::fflush(stdout);
  ::fcntl(STDIN_FILENO, F_SETFL, O_NONBLOCK);
  // An arm's control does not share a processor with the programs of a test; where that is allowed.
  sched_param priority{};
  priority.sched_priority = 80;
  ::sched_setscheduler(0, SCHED_FIFO, &priority);
  std::string typed;
  Reading wrench;
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  auto next = Clock::now();
  while (true) {
    char text[4096];
    const ssize_t count = ::read(STDIN_FILENO, text, sizeof(text));
    if (count == 0) return 0;  // the test has ended
    if (count > 0) typed.append(text, static_cast<std::size_t>(count));
    for (std::size_t end = typed.find('\n'); end != std::string::npos; end = typed.find('\n')) {
      obey(typed.substr(0, end), arm, sockets, wrench);
      typed.erase(0, end + 1);
    }
    const std::int64_t now_ns = Clock::now().time_since_epoch() / std::chrono::nanoseconds(1);
    for (std::size_t i = 0; i < arm.F_K.size(); ++i)
      arm.F_K[i] = wrench.mean[i] + wrench.noise * normal(random);
    sockets.receive(arm);
    arm.step(now_ns);
    sockets.send(arm, now_ns);
    next += std::chrono::milliseconds(1);
    // Each state leaves time for its answer, also after a delay.
    next = std::max(next, Clock::now() + std::chrono::microseconds(800));
    std::this_thread::sleep_until(next);
  }
}
