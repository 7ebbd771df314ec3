#include "participant.hpp"

#include <cstdlib>
#include <stdexcept>

namespace palpate::ros2_bridge {
namespace {

constexpr dds_duration_t kLongestWait = DDS_MSECS(1);  // of a cycle, for a slow reliable reader

dds_entity_t check(dds_entity_t result, const std::string& what) {
  if (result < 0) throw std::runtime_error("DDS: " + what + ": " + dds_strretcode(-result));
  return result;
}

std::string xml_escaped(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '&' || c == '<' || c == '>' || c == '"')
      escaped += "&#" + std::to_string(static_cast<int>(c)) + ";";
    else
      escaped += c;
  }
  return escaped;
}

/// Of Cyclone DDS. Samples are bounded, as any node of the domain may send them.
std::string configuration(const Participant::Options& options) {
  std::string xml;
  if (const char* const given = std::getenv("CYCLONEDDS_URI"); given != nullptr && *given != 0)
    xml = std::string(given) + ",";
  xml += "<Domain><Internal><MaxSampleSize>64 MB</MaxSampleSize></Internal>";
  if (!options.interface.empty())
    xml += "<General><Interfaces><NetworkInterface name=\"" + xml_escaped(options.interface) +
           "\"/></Interfaces></General>";
  if (!options.peers.empty()) {
    xml += "<Discovery><ParticipantIndex>auto</ParticipantIndex><Peers>";
    for (const std::string& peer : options.peers)
      xml += "<Peer Address=\"" + xml_escaped(peer) + "\"/>";
    xml += "</Peers></Discovery>";
  }
  return xml + "</Domain>";
}

class Qos {
 public:
  explicit Qos(const Participant::Endpoint& endpoint) : qos_(dds_create_qos()) {
    dds_qset_reliability(qos_,
                         endpoint.quality == Quality::kReliable ? DDS_RELIABILITY_RELIABLE
                                                                : DDS_RELIABILITY_BEST_EFFORT,
                         kLongestWait);
    dds_qset_history(qos_, DDS_HISTORY_KEEP_LAST, endpoint.depth);
    dds_qset_durability(qos_, DDS_DURABILITY_VOLATILE);
    if (endpoint.ignores_own) dds_qset_ignorelocal(qos_, DDS_IGNORELOCAL_PARTICIPANT);
  }
  ~Qos() { dds_delete_qos(qos_); }
  Qos(const Qos&) = delete;
  Qos& operator=(const Qos&) = delete;

  /// As ROS 2 reads it: "key=value;".
  void announce(const Type& type, const Participant::Endpoint& endpoint) {
    std::string text = endpoint.user_data;
    if (*type.hash != 0) text += std::string("typehash=RIHS01_") + type.hash + ";";
    if (!text.empty()) dds_qset_userdata(qos_, text.data(), text.size());
  }
  const dds_qos_t* get() const { return qos_; }

 private:
  dds_qos_t* qos_;
};

}  // namespace

Participant::Participant(const Options& options) {
  const auto number = static_cast<dds_domainid_t>(options.domain);
  const dds_entity_t domain = dds_create_domain(number, configuration(options).c_str());
  if (domain != DDS_RETCODE_PRECONDITION_NOT_MET)
    domain_ = check(domain, "domain " + std::to_string(options.domain) +
                                (options.interface.empty() ? "" : " on " + options.interface));
  participant_ = dds_create_participant(number, nullptr, nullptr);
  if (participant_ < 0 && domain_ > 0) dds_delete(domain_);
  check(participant_, "participant in domain " + std::to_string(options.domain));
  dds_guid_t guid;
  dds_get_guid(participant_, &guid);
  for (const std::uint8_t byte : guid.v) id_ += (id_.empty() ? "" : ".") + std::to_string(byte);
}

Participant::~Participant() { dds_delete(domain_ > 0 ? domain_ : participant_); }

dds_entity_t Participant::make_topic(const Type& type, const Endpoint& endpoint) const {
  const std::string name = endpoint.prefix + endpoint.topic + endpoint.suffix;
  return check(dds_create_topic(participant_, type.descriptor, name.c_str(), nullptr, nullptr),
               "topic " + name);
}

dds_entity_t Participant::make_reader(const Type& type, const Endpoint& endpoint) const {
  Qos qos(endpoint);
  qos.announce(type, endpoint);
  return check(dds_create_reader(participant_, make_topic(type, endpoint), qos.get(), nullptr),
               "reader of " + endpoint.topic);
}

dds_entity_t Participant::make_writer(const Type& type, const Endpoint& endpoint) const {
  Qos qos(endpoint);
  qos.announce(type, endpoint);
  return check(dds_create_writer(participant_, make_topic(type, endpoint), qos.get(), nullptr),
               "writer of " + endpoint.topic);
}

}  // namespace palpate::ros2_bridge
