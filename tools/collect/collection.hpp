#pragma once

#include <filesystem>
#include <functional>

#include "tools/collect/bench.hpp"

namespace palpate::collect {

/// Writes trials in sequence to a file that palpate-train reads. A trial is written completely or
/// not at all.
class CollectionFile {
 public:
  virtual ~CollectionFile() = default;
  virtual void add(const Trial& trial, const std::vector<Sample>& samples) = 0;
  /// Number of trials already in the file.
  virtual int trials() const = 0;
};

/// *.log: an LCM event log of BIOTAC_0 and FT_WRENCH, as a hand sends them, and of a
/// COMPONENT_EVENT at the start of each trial; trials are 2 s apart. Otherwise CSV, one row per
/// reading of the BioTac, with the columns trial, probe, area, profile, t, fx to fz, tx to tz,
/// pac0, pac1, pdc, tac, tdc, e1 to e19. `resume`: appends to an existing CSV. Throws
/// std::runtime_error if the file cannot be written or does not match, std::invalid_argument if a
/// log is to be resumed.
std::unique_ptr<CollectionFile> open_collection(const std::filesystem::path& path, bool resume);

}  // namespace palpate::collect
