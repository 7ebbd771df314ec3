#include <arpa/inet.h>

#include <algorithm>
#include <cstdlib>

#include "tools/doctor/checks.hpp"

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

constexpr std::int64_t kWantedBuffer =
    4 << 20;  // bytes; with less, messages are lost during a concurrent flood
constexpr std::int64_t kBuffer = 16'777'216;  // that palpated requests
constexpr int kMulticastFlag = 0x1000, kUpFlag = 0x1;
constexpr char kRoute[] = "sudo ip link set lo multicast on\nsudo ip route add 224.0.0.0/4 dev lo";

Finding check_buffer(const Machine& machine, const Needs& needs) {
  const std::int64_t largest = machine.number("proc/sys/net/core/rmem_max").value_or(0);
  const std::int64_t asked =
      std::max({kWantedBuffer, std::int64_t{needs.control.receive_buffer_size},
                std::int64_t{needs.housekeeping.receive_buffer_size}});
  const std::string text = "net.core.rmem_max is " + std::to_string(largest);
  if (largest >= asked) return ok("buffer", text);
  return warn("buffer", text + ", wanted " + std::to_string(asked),
              "while the machine is busy or floods the port, messages are lost in the socket",
              "sudo sysctl -w net.core.rmem_max=" + std::to_string(std::max(asked, kBuffer)) +
                  "\necho net.core.rmem_max=" + std::to_string(std::max(asked, kBuffer)) +
                  " | sudo tee /etc/sysctl.d/60-palpate.conf");
}

Finding check_route(const Machine& machine, const std::string& check, const bus::UdpmUrl& url) {
  const std::optional<std::string> device = route_to(machine, url.address);
  if (!device) {
    return fail(check, "no route to " + url.address, "LCM can neither send nor listen", kRoute);
  }
  const std::string flags_text =
      machine.read("sys/class/net/" + *device + "/flags").value_or("0x0");
  const long flags = std::strtol(flags_text.c_str(), nullptr, 16);
  if ((flags & kUpFlag) == 0) {
    return fail(check, url.address + " goes by " + *device + ", which is down",
                "LCM can neither send nor listen", "sudo ip link set " + *device + " up");
  }
  if ((flags & kMulticastFlag) == 0) {
    return fail(check, url.address + " goes by " + *device + ", which takes no multicast",
                "LCM's messages do not arrive", "sudo ip link set " + *device + " multicast on");
  }
  if (url.ttl > 0 && *device == "lo") {
    return warn(check, url.text() + " goes by lo",
                "ttl says that other machines are to receive it, but lo ends on this one",
                "sudo ip route replace " + url.address + "/32 dev DEVICE   # that leads to them");
  }
  return ok(check, url.address + " goes by " + *device);
}

Finding check_ttl(const Needs& needs) {
  const int ttl = std::max(needs.control.ttl, needs.housekeeping.ttl);
  if (ttl == 0) return ok("ttl", "0: messages stay on this machine");
  if (ttl == 1) return ok("ttl", "1: messages stay in this network");
  return warn("ttl", std::to_string(ttl),
              "messages pass routers: sensors and commands are heard, and can be sent, beyond this "
              "network",
              "set ttl=0 (this machine) or ttl=1 (this network) in bus.control and "
              "bus.housekeeping, and access.key_file where others share it");
}

Finding check_urls(const Needs& needs) {
  if (needs.control.group() == needs.housekeeping.group())
    return warn("urls", "control and housekeeping are both " + needs.control.group(),
                "shapes and meshes fill the socket that sensors need",
                "give bus.housekeeping another address or port");
  if (needs.control.port == needs.housekeeping.port)
    return warn("urls", "control and housekeeping share port " + std::to_string(needs.control.port),
                "stock LCM programs hear all groups of a port, and lose more",
                "give bus.housekeeping another port");
  return ok("urls", needs.control.group() + " and " + needs.housekeeping.group());
}

/// The sockets that receive on a URL's port, and whether that is harmful.
Finding check_listeners(const Machine& machine, const std::string& check, const bus::UdpmUrl& url) {
  std::string who, stopped, losing;
  int unseen = 0;
  for (const BoundSocket& socket : udp_sockets(machine, url.port)) {
    if (socket.address != url.address && socket.address != "0.0.0.0") continue;
    const std::optional<Holder> holder = holder_of(machine, socket.inode);
    if (!holder) {
      ++unseen;
      continue;
    }
    const std::string text = holder->name + " (" + std::to_string(holder->pid) + ")";
    if (who.find(text) == std::string::npos) who += (who.empty() ? "" : ", ") + text;
    if (holder->state == 'T' || holder->state == 't') stopped = std::to_string(holder->pid);
    if (socket.drops > 0) losing += text + " lost " + std::to_string(socket.drops) + "; ";
  }
  if (unseen > 0)
    who += (who.empty() ? "" : ", ") + std::to_string(unseen) + " that are not mine to see";
  const std::string text = url.group() + ": " + (who.empty() ? "no listener" : who);
  if (!stopped.empty())
    return warn(check, text, "process " + stopped + " is stopped and still a member of the group",
                "kill -CONT " + stopped + "   # or, to end it: kill -KILL " + stopped);
  if (!losing.empty())
    return warn(
        check, losing + "because the socket buffer is full",
        "what a listener loses it does not know of",
        "sudo sysctl -w net.core.rmem_max=" + std::to_string(kBuffer) + "   # then restart it");
  return ok(check, text);
}

/// Daemons on this machine hold an abstract socket for each URL.
Finding check_lock(const Machine& machine, const Needs& needs) {
  const std::string name = "@palpate/palpated/" + needs.control.group();
  for (const std::string& line : machine.lines("proc/net/unix")) {
    const std::vector<std::string> words = words_of(line);
    if (words.size() < 8 || words[7] != name) continue;
    const std::optional<Holder> holder =
        holder_of(machine, std::strtoll(words[6].c_str(), nullptr, 10));
    return ok("daemon", "palpated runs on " + needs.control.group() +
                            (holder ? ", process " + std::to_string(holder->pid) : "") +
                            "; another one would be refused");
  }
  return ok("daemon", "no palpated runs on " + needs.control.group());
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

Findings check_network(const Machine& machine, const Needs& needs) {
  return {check_buffer(machine, needs),
          check_route(machine, "route", needs.control),
          check_route(machine, "route_housekeeping", needs.housekeeping),
          check_ttl(needs),
          check_urls(needs),
          check_listeners(machine, "listeners", needs.control),
          check_listeners(machine, "listeners_housekeeping", needs.housekeeping),
          check_lock(machine, needs)};
}

}  // namespace palpate::doctor
