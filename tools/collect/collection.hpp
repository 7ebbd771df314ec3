#pragma once

#include <filesystem>
#include <functional>

#include "tools/collect/bench.hpp"

namespace palpate::collect {

/// Writes trials one behind the other to a file that palpate-train reads. A trial stands in it
/// whole or not at all.
class CollectionFile {
 public:
  virtual ~CollectionFile() = default;
  virtual void add(const Trial& trial, const std::vector<Sample>& samples) = 0;
  /// How many trials the file holds already.
  virtual int trials() const = 0;
};

/// *.log: an LCM event log of BIOTAC_0 and FT_WRENCH, of the messages that a hand sends, and of
/// COMPONENT_EVENT where a trial begins; trials lie 2 s apart. Else CSV, a row a reading of the
/// BioTac, with the columns trial, probe, area, profile, t, fx to fz, tx to tz, pac0, pac1, pdc,
/// tac, tdc, e1 to e19. `resume`: goes on behind the trials of a CSV that is there. Throws
/// std::runtime_error where the file cannot be written or does not fit, std::invalid_argument for a
/// log that shall be resumed.
std::unique_ptr<CollectionFile> open_collection(const std::filesystem::path& path, bool resume);

}  // namespace palpate::collect
