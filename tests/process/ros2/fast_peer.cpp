// A node of ROS 2 by Fast DDS, whose messages are given and printed as hexadecimal CDR, and an arm.
// usage: fast_peer DOMAIN, and then lines on standard input:
//   writer|reader TOPIC TYPE reliable|stream     TOPIC and TYPE as DDS knows them
//   write TOPIC HEX                              "got TOPIC HEX" is printed for what is read
//   matches TOPIC                                "matches N": endpoints that have been found
//   arm velocities|twist STATES COMMANDS WRENCH COMPENSATED NAME=Q ...     "-": no sensor
//   fault [silent|nan|late|short]
//   state, latency                               see FastArm

#include <cstdio>
#include <iostream>
#include <sstream>

#include "fast_arm.hpp"

namespace {

using fast_peer::Bytes;
using fast_peer::FastArm;

std::mutex printing;

void print(const std::string& line) {
  const std::lock_guard lock(printing);
  std::printf("%s\n", line.c_str());
  std::fflush(stdout);
}

std::string hex_of(const Bytes& message) {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string text;
  for (const std::uint8_t byte : message) {
    text += kDigits[byte >> 4];
    text += kDigits[byte & 15];
  }
  return text;
}

Bytes bytes_of(const std::string& hex) {
  Bytes message;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 2)
    message.push_back(static_cast<std::uint8_t>(std::stoi(hex.substr(i, 2), nullptr, 16)));
  return message;
}

FastArm::Options read_arm(std::istream& words) {
  FastArm::Options options;
  std::string kind, joint;
  words >> kind >> options.states >> options.commands >> options.wrench >> options.compensated;
  options.takes_twists = kind == "twist";
  if (options.wrench == "-") options.wrench.clear();
  while (words >> joint) {
    const std::size_t equals = joint.find('=');
    options.names.push_back(joint.substr(0, equals));
    options.q.push_back(std::stod(joint.substr(equals + 1)));
  }
  return options;
}

}  // namespace

int main(int, char** argv) {
  fast_peer::RawDds dds(std::stoi(argv[1]));
  std::unique_ptr<FastArm> arm;
  for (std::string line; std::getline(std::cin, line);) {
    std::istringstream words(line);
    std::string what, topic, type, quality;
    words >> what;
    if (what == "arm") arm = std::make_unique<FastArm>(dds, read_arm(words));
    if (what == "state") print("state " + arm->state());
    if (what == "latency") print("latency " + arm->latency());
    words >> topic >> type >> quality;
    if (what == "fault") arm->set_fault(topic);
    if (what == "matches") print("matches " + std::to_string(dds.matches(topic)));
    if (what == "write") dds.write(topic, bytes_of(type));
    if (what == "writer") dds.add_writer(topic, type, quality == "reliable");
    if (what == "reader")
      dds.add_reader(topic, type, quality == "reliable", [topic](const Bytes& message) {
        print("got " + topic + " " + hex_of(message));
      });
  }
}
