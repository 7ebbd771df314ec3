#pragma once

namespace palpate {

/// Condition of a component after an update. kDegraded: it works with reduced quality, or waits for
/// an input, and recovers by itself. kFault: it does not work until it is reset. kDoubtful, of an
/// estimator: it works and nothing else is wrong, but the wrenches contradict the model; control
/// then follows its policy, whereas it does not move the robot by an estimate that is kDegraded.
enum class Status { kOk, kDegraded, kFault, kDoubtful };

/// Outcome of an update, of every slot. `reason` is a string literal, "" for kOk.
struct [[nodiscard]] UpdateResult {
  Status status = Status::kOk;
  const char* reason = "";

  bool is_ok() const noexcept { return status == Status::kOk; }
  /// Takes a later result of the same update unless that is kOk.
  void take(const UpdateResult& later) noexcept {
    if (!later.is_ok()) *this = later;
  }
};

/// Whether an input has never arrived, is the one of an earlier cycle, or arrived in this cycle.
enum class Freshness { kNoData, kOld, kNew };

}  // namespace palpate
