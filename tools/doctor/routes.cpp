#include "tools/doctor/routes.hpp"

#include <arpa/inet.h>

#include <algorithm>
#include <cstdlib>

namespace palpate::doctor {
namespace {

constexpr std::uint32_t kUp = 0x1, kReject = 0x200;

std::uint32_t hexadecimal(const std::string& text) {
  return static_cast<std::uint32_t>(std::strtoul(text.c_str(), nullptr, 16));
}

std::string dotted(std::uint32_t network_order) {
  char text[INET_ADDRSTRLEN] = "";
  in_addr address{};
  address.s_addr = network_order;
  inet_ntop(AF_INET, &address, text, sizeof(text));
  return text;
}

bool is_number(const std::string& text) {
  return !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
}

}  // namespace

std::optional<std::string> route_to(const Machine& machine, const std::string& address) {
  in_addr wanted{};
  inet_pton(AF_INET, address.c_str(), &wanted);
  std::optional<std::string> device;
  std::uint32_t best_mask = 0;
  long best_metric = 0;
  bool rejected = false;
  for (const std::string& line : machine.lines("proc/net/route")) {
    const std::vector<std::string> words = words_of(line);
    if (words.size() < 8 || words[0] == "Iface") continue;
    const std::uint32_t flags = hexadecimal(words[3]);
    const std::uint32_t mask = ntohl(hexadecimal(words[7]));
    const long metric = std::strtol(words[6].c_str(), nullptr, 10);
    if ((flags & kUp) == 0) continue;
    if ((ntohl(wanted.s_addr) & mask) != (ntohl(hexadecimal(words[1])) & mask)) continue;
    if (device && (mask < best_mask || (mask == best_mask && metric >= best_metric))) continue;
    device = words[0];
    best_mask = mask;
    best_metric = metric;
    rejected = (flags & kReject) != 0;
  }
  return rejected ? std::nullopt : device;
}

std::vector<BoundSocket> udp_sockets(const Machine& machine, int port) {
  std::vector<BoundSocket> sockets;
  for (const std::string& line : machine.lines("proc/net/udp")) {
    const std::vector<std::string> words = words_of(line);
    if (words.size() < 13 || words[0].back() != ':') continue;
    const std::size_t colon = words[1].find(':');
    if (colon == std::string::npos) continue;
    BoundSocket one;
    one.address = dotted(hexadecimal(words[1].substr(0, colon)));
    one.port = static_cast<int>(hexadecimal(words[1].substr(colon + 1)));
    one.inode = std::strtoll(words[9].c_str(), nullptr, 10);
    one.drops = std::strtoll(words[12].c_str(), nullptr, 10);
    if (one.port == port) sockets.push_back(one);
  }
  return sockets;
}

std::optional<Holder> holder_of(const Machine& machine, std::int64_t inode) {
  const std::string wanted = "socket:[" + std::to_string(inode) + "]";
  for (const std::string& pid : machine.list("proc")) {
    if (!is_number(pid)) continue;
    const std::string folder = "proc/" + pid;
    const std::vector<std::string> files = machine.list(folder + "/fd");
    const bool holds = std::any_of(files.begin(), files.end(), [&](const std::string& file) {
      return machine.link(folder + "/fd/" + file) == wanted;
    });
    if (!holds) continue;
    Holder holder;
    holder.pid = std::atoi(pid.c_str());
    holder.name = machine.read(folder + "/comm").value_or("?");
    for (const std::string& line : machine.lines(folder + "/status")) {
      if (line.rfind("State:", 0) == 0 && words_of(line).size() > 1)
        holder.state = words_of(line)[1][0];
    }
    return holder;
  }
  return std::nullopt;
}

}  // namespace palpate::doctor
