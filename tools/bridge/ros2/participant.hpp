#pragma once

#include <dds/dds.h>

#include <string>
#include <vector>

#include "messages.hpp"

namespace palpate::ros2_bridge {

/// Quality of service: kStream, best effort, matches every publisher of sensor data; kReliable is
/// repeated until it has arrived. Both keep the last few messages and are volatile.
enum class Quality { kStream, kReliable };

/// A participant in a ROS 2 domain, and its endpoints. All functions throw std::runtime_error with
/// the name of what DDS has refused.
class Participant {
 public:
  struct Options {
    int domain = 0;                  // ROS_DOMAIN_ID of the peers
    std::string interface;           // name of a network interface; empty: Cyclone DDS chooses
    std::vector<std::string> peers;  // hosts that multicast does not reach
  };
  struct Endpoint {
    std::string topic;  // of ROS 2, without a slash in front
    Quality quality = Quality::kStream;
    int depth = 1;             // messages that are kept
    bool ignores_own = false;  // a reader: what this participant writes
    std::string prefix = "rt/", suffix = {}, user_data = {};  // of a service
  };

  /// Adds to what CYCLONEDDS_URI configures.
  explicit Participant(const Options& options);
  ~Participant();
  Participant(const Participant&) = delete;
  Participant& operator=(const Participant&) = delete;

  dds_entity_t make_reader(const Type& type, const Endpoint& endpoint) const;
  dds_entity_t make_writer(const Type& type, const Endpoint& endpoint) const;
  /// Unique in the domain.
  const std::string& id() const { return id_; }

 private:
  dds_entity_t make_topic(const Type& type, const Endpoint& endpoint) const;

  dds_entity_t domain_ = 0;  // 0: another participant of this process has made it
  dds_entity_t participant_ = 0;
  std::string id_;
};

/// Receives the messages of a topic.
template <class Message>
class Reader {
 public:
  Reader(const Participant& participant, const Participant::Endpoint& endpoint)
      : entity_(participant.make_reader(type_of(static_cast<Message*>(nullptr)), endpoint)) {}
  ~Reader() {
    release();
    dds_delete(entity_);
  }
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;

  /// The oldest one, valid until the next call; nullptr if there is none. The messages are well
  /// formed: DDS drops others.
  const Message* next() {
    release();
    dds_sample_info_t info;
    while (dds_take(entity_, &sample_, &info, 1, 1) == 1) {
      publication_ = info.publication_handle;
      if (info.valid_data) return static_cast<const Message*>(sample_);
      release();
    }
    sample_ = nullptr;
    return nullptr;
  }
  /// Of the last message's writer.
  dds_instance_handle_t publication() const { return publication_; }
  dds_entity_t entity() const { return entity_; }

 private:
  void release() {
    if (sample_ != nullptr) dds_return_loan(entity_, &sample_, 1);
    sample_ = nullptr;
  }

  dds_entity_t entity_;
  void* sample_ = nullptr;  // lent by DDS
  dds_instance_handle_t publication_ = 0;
};

/// Publishes messages of a topic; from one thread at a time.
template <class Message>
class Writer {
 public:
  Writer(const Participant& participant, const Participant::Endpoint& endpoint)
      : entity_(participant.make_writer(type_of(static_cast<Message*>(nullptr)), endpoint)) {}
  ~Writer() { dds_delete(entity_); }
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;

  /// Copies the message. False if a reader that is too slow has no room left.
  bool write(const Message& message) { return dds_write(entity_, &message) == DDS_RETCODE_OK; }
  /// Waits, at most 0.2 s, until all reliable readers have everything.
  void flush() { dds_wait_for_acks(entity_, DDS_MSECS(200)); }
  dds_entity_t entity() const { return entity_; }

 private:
  dds_entity_t entity_;
};

}  // namespace palpate::ros2_bridge
