#pragma once

namespace palpate {

/// Condition of a component after an update. kDegraded: it works with reduced quality, or waits for
/// an input, and recovers by itself. kFault: it does not work until it is reset.
enum class Status { kOk, kDegraded, kFault };

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
