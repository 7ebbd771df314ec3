#include "cloud_relay.hpp"

#include <cstdio>
#include <stdexcept>

#include "rt/bus/authentication.hpp"

namespace palpate::ros2_bridge {

CloudRelay::CloudRelay(const Participant& participant, const Options& options)
    : options_(options),
      clouds_(participant, {options.topic, Quality::kStream, 1}),
      intake_(options.topic, options.clock),
      lcm_(options.url),
      waitset_(dds_create_waitset(dds_get_participant(clouds_.entity()))),
      ended_(dds_create_guardcondition(dds_get_participant(clouds_.entity()))) {
  if (!lcm_.good())
    throw std::runtime_error("liblcm cannot open " + options.url + "; its message is above");
  dds_set_status_mask(clouds_.entity(), DDS_DATA_AVAILABLE_STATUS);
  dds_waitset_attach(waitset_, clouds_.entity(), 0);
  dds_waitset_attach(waitset_, ended_, 1);
  thread_ = std::thread([this] { run(); });
}

CloudRelay::~CloudRelay() {
  dds_set_guardcondition(ended_, true);
  thread_.join();
  dds_delete(waitset_);
  dds_delete(ended_);
}

void CloudRelay::run() {
  drake::lcmt_point_cloud cloud;
  bool has_ended = false;
  while (!has_ended) {
    dds_waitset_wait(waitset_, nullptr, 0, DDS_INFINITY);
    while (const PointCloud2* const message = clouds_.next()) {
      if (const char* const reason = convert(*message, cloud)) {
        intake_.refuse(reason);
      } else if (const auto utime = intake_.admit(message->header.stamp, bus::wall_clock_us())) {
        cloud.utime = *utime;
        lcm_.publish(options_.channel, &cloud);
      }
    }
    for (std::string text = intake_.complaint(); !text.empty(); text = intake_.complaint())
      std::fprintf(stderr, "%s\n", text.c_str());
    dds_read_guardcondition(ended_, &has_ended);
  }
}

}  // namespace palpate::ros2_bridge
