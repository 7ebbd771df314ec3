#include "tools/log/log_reader.hpp"

#include <algorithm>
#include <iostream>
#include <memory>
#include <palpate/channels.hpp>

namespace palpate::log {

void LogReader::collect(const std::string& channel, std::vector<shape_t>& into,
                        std::int64_t least_period) {
  const auto assembler = std::make_shared<bus::ShapeAssembler>();
  handlers_[channel] = [&into, assembler, least_period,
                        clock = clock_](const bus::LoggedEvent& event) {
    shape_t chunk;
    if (!bus::decode(chunk, event.data, event.size)) return false;
    shape_t* shape = assembler->add(std::move(chunk));
    if (shape == nullptr) return true;
    if (clock == LogClock::kReceived) shape->utime = event.utime;
    if (is_due(into, *shape, least_period)) into.push_back(std::move(*shape));
    return true;
  };
}

void LogReader::read(const std::filesystem::path& log) {
  bus::EventLogReader file(log.string());
  while (const bus::LoggedEvent* event = file.next()) {
    ++events_;
    const auto handler = handlers_.find(event->channel);
    if (handler != handlers_.end() && !handler->second(*event)) ++undecodable_;
  }
  const std::string complaint = file.complaint();
  if (!complaint.empty()) std::cerr << "warning: " << complaint << std::endl;
}

namespace {

void take_times_from_features(std::vector<shape_target_t>& targets,
                              const std::vector<feature_t>& features) {
  for (shape_target_t& target : targets)
    for (const feature_t& feature : features) {
      if (feature.revision != target.revision) continue;
      target.utime = feature.utime;
      break;
    }
}

/// Datagrams overtake each other on a busy machine; the sequence number gives the order of sending.
template <class... Messages>
void order_as_sent(std::vector<Messages>&... messages) {
  const auto earlier = [](const auto& a, const auto& b) {
    return a.utime != b.utime ? a.utime < b.utime : a.seq < b.seq;
  };
  (std::stable_sort(messages.begin(), messages.end(), earlier), ...);
}

}  // namespace

RunLog read_run(const std::filesystem::path& control, const std::filesystem::path& housekeeping,
                LogClock clock, std::int64_t least_period) {
  RunLog run;
  LogReader loop(clock);
  loop.collect(channel::kTwistCommand, run.commands, least_period);
  loop.collect(channel::kFeature, run.features);
  loop.collect(channel::kEstimate, run.estimates, least_period);
  loop.collect(channel::kUnknownContact, run.unknown_contacts);
  loop.collect(channel::kDiscrepancy, run.discrepancies);
  loop.collect(channel::kShapeTarget, run.targets);
  loop.collect(channel::kRobotState, run.robot, least_period);
  loop.collect(channel::kContacts, run.contacts, least_period);
  loop.collect(channel::kShapeObservation, run.observations);
  loop.read(control);
  if (clock == LogClock::kSent) {
    order_as_sent(run.commands, run.features, run.estimates, run.unknown_contacts,
                  run.discrepancies, run.robot, run.contacts, run.observations);
    take_times_from_features(run.targets, run.features);
  }

  LogReader slow(clock);
  slow.collect(channel::kShape, run.shapes, least_period);
  slow.collect(channel::kShapeMesh, run.shape_chunks);
  slow.collect(channel::kTruthShape, run.truths, least_period);
  slow.collect(channel::kTruthMesh, run.truth_chunks);
  slow.collect(channel::kTruthContact, run.truth_contacts, least_period);
  slow.collect(channel::kTruthTouch, run.truth_touches);
  slow.collect(channel::kHealth, run.health);
  slow.collect(channel::kComponentEvent, run.events);
  slow.read(housekeeping);
  if (clock == LogClock::kSent)
    order_as_sent(run.shapes, run.shape_chunks, run.truths, run.truth_chunks, run.truth_contacts,
                  run.truth_touches, run.health, run.events);
  return run;
}

}  // namespace palpate::log
