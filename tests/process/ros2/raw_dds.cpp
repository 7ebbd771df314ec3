#include "raw_dds.hpp"

#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <cstring>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <stdexcept>

namespace fast_peer {
namespace {

namespace dds = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;

/// Bytes of any type, by its name alone.
class RawType final : public dds::TopicDataType {
 public:
  explicit RawType(const std::string& name) {
    setName(name.c_str());
    m_typeSize = 4096;  // at first
    m_isGetKeyDefined = false;
    auto_fill_type_information(false);
    auto_fill_type_object(false);
  }
  bool serialize(void* data, rtps::SerializedPayload_t* payload) override {
    const Bytes& bytes = *static_cast<Bytes*>(data);
    std::memcpy(payload->data, bytes.data(), bytes.size());
    payload->length = static_cast<std::uint32_t>(bytes.size());
    payload->encapsulation = CDR_LE;
    return true;
  }
  bool deserialize(rtps::SerializedPayload_t* payload, void* data) override {
    static_cast<Bytes*>(data)->assign(payload->data, payload->data + payload->length);
    return true;
  }
  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) override {
    const auto size = static_cast<std::uint32_t>(static_cast<Bytes*>(data)->size());
    return [size] { return size; };
  }
  void* createData() override { return new Bytes; }
  void deleteData(void* data) override { delete static_cast<Bytes*>(data); }
  bool getKey(void*, rtps::InstanceHandle_t*, bool) override { return false; }
};

}  // namespace

class RawDds::Listener final : public dds::DataReaderListener {
 public:
  explicit Listener(std::function<void(const Bytes&)> take) : take_(std::move(take)) {}
  void on_data_available(dds::DataReader* reader) override {
    dds::SampleInfo info;
    while (reader->take_next_sample(&message_, &info) == ReturnCode_t::RETCODE_OK)
      if (info.valid_data) take_(message_);
  }

 private:
  std::function<void(const Bytes&)> take_;
  Bytes message_;
};

RawDds::RawDds(int domain) {
  dds::DomainParticipantQos qos = dds::PARTICIPANT_QOS_DEFAULT;
  const auto udp = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
  udp->interfaceWhiteList.push_back("127.0.0.1");
  qos.transport().use_builtin_transports = false;
  qos.transport().user_transports.push_back(udp);
  participant_ = dds::DomainParticipantFactory::get_instance()->create_participant(
      static_cast<std::uint32_t>(domain), qos);
  if (participant_ == nullptr) throw std::runtime_error("Fast DDS makes no participant");
  publisher_ = participant_->create_publisher(dds::PUBLISHER_QOS_DEFAULT);
  subscriber_ = participant_->create_subscriber(dds::SUBSCRIBER_QOS_DEFAULT);
}

RawDds::~RawDds() {
  participant_->delete_contained_entities();
  dds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
}

dds::Topic* RawDds::topic_of(const std::string& topic, const std::string& type) {
  if (auto* const known = dynamic_cast<dds::Topic*>(participant_->lookup_topicdescription(topic)))
    return known;
  dds::TypeSupport(new RawType(type)).register_type(participant_);
  return participant_->create_topic(topic, type, dds::TOPIC_QOS_DEFAULT);
}

void RawDds::add_writer(const std::string& topic, const std::string& type, bool is_reliable) {
  dds::DataWriterQos qos = dds::DATAWRITER_QOS_DEFAULT;
  qos.reliability().kind =
      is_reliable ? dds::RELIABLE_RELIABILITY_QOS : dds::BEST_EFFORT_RELIABILITY_QOS;
  qos.durability().kind = dds::VOLATILE_DURABILITY_QOS;
  qos.history().depth = 10;
  qos.endpoint().history_memory_policy = rtps::DYNAMIC_RESERVE_MEMORY_MODE;
  auto* const writer = publisher_->create_datawriter(topic_of(topic, type), qos);
  const std::lock_guard lock(mutex_);
  endpoints_.push_back({topic, writer, nullptr, nullptr});
}

void RawDds::add_reader(const std::string& topic, const std::string& type, bool is_reliable,
                        std::function<void(const Bytes&)> take) {
  dds::DataReaderQos qos = dds::DATAREADER_QOS_DEFAULT;
  qos.reliability().kind =
      is_reliable ? dds::RELIABLE_RELIABILITY_QOS : dds::BEST_EFFORT_RELIABILITY_QOS;
  qos.history().depth = 10;
  qos.endpoint().history_memory_policy = rtps::DYNAMIC_RESERVE_MEMORY_MODE;
  auto listener = std::make_unique<Listener>(std::move(take));
  auto* const reader = subscriber_->create_datareader(topic_of(topic, type), qos, listener.get());
  const std::lock_guard lock(mutex_);
  endpoints_.push_back({topic, nullptr, reader, std::move(listener)});
}

void RawDds::write(const std::string& topic, Bytes message) {
  const std::lock_guard lock(mutex_);
  for (const Endpoint& endpoint : endpoints_)
    if (endpoint.topic == topic && endpoint.writer != nullptr) endpoint.writer->write(&message);
}

int RawDds::matches(const std::string& topic) const {
  const std::lock_guard lock(mutex_);
  int count = 0;
  for (const Endpoint& endpoint : endpoints_) {
    if (endpoint.topic != topic) continue;
    dds::PublicationMatchedStatus readers;
    dds::SubscriptionMatchedStatus writers;
    if (endpoint.writer != nullptr) endpoint.writer->get_publication_matched_status(readers);
    if (endpoint.reader != nullptr) endpoint.reader->get_subscription_matched_status(writers);
    count += readers.current_count + writers.current_count;
  }
  return count;
}

}  // namespace fast_peer
