#pragma once

#include <cstdint>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace fast_peer {

/// An encoded message with its encapsulation header of 4 bytes, as it is sent.
using Bytes = std::vector<std::uint8_t>;

/// Writers and readers of encoded messages by Fast DDS, on the loopback interface.
class RawDds {
 public:
  explicit RawDds(int domain);
  ~RawDds();

  /// `topic`, `type`: of DDS, such as rt/chatter and std_msgs::msg::dds_::String_.
  void add_writer(const std::string& topic, const std::string& type, bool is_reliable);
  /// `take` is called by a thread of Fast DDS.
  void add_reader(const std::string& topic, const std::string& type, bool is_reliable,
                  std::function<void(const Bytes&)> take);
  void write(const std::string& topic, Bytes message);
  /// Numbers of readers that a writer, or writers that a reader has found.
  int matches(const std::string& topic) const;

 private:
  class Listener;
  struct Endpoint {
    std::string topic;
    eprosima::fastdds::dds::DataWriter* writer;  // or nullptr
    eprosima::fastdds::dds::DataReader* reader;  // or nullptr
    std::unique_ptr<Listener> listener;          // of the reader
  };
  eprosima::fastdds::dds::Topic* topic_of(const std::string& topic, const std::string& type);

  eprosima::fastdds::dds::DomainParticipant* participant_;
  eprosima::fastdds::dds::Publisher* publisher_;
  eprosima::fastdds::dds::Subscriber* subscriber_;
  mutable std::mutex mutex_;
  std::vector<Endpoint> endpoints_;
};

}  // namespace fast_peer
