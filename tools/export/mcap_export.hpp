#pragma once

#include <filesystem>
#include <optional>

#include "core/math/rigid.hpp"
#include "tools/export/csv_export.hpp"
#include "tools/export/mcap_writer.hpp"
#include "tools/export/shape_follower.hpp"

namespace palpate::exporting {

struct McapOptions {
  Compression compression = Compression::kZstd;
  double scene_rate = 20;          // Hz, of the added channels for 3-D views; 0: none
  std::optional<math::Pose> X_WO;  // pose of the object, if known
  bool protobuf = false;           // the added channels in Protobuf in place of JSON
};

/// Writes the selected channels to one MCAP file as JSON messages with their schemas
/// (palpate.TYPE; those of SourceOptions::types by their own names). log_time is that of the
/// selected clock, publish_time the sender's utime. For Foxglove's 3-D view it adds /shape/estimate
/// and /shape/truth (SceneUpdate, in frame O), /flange (PoseInFrame) and /tf (FrameTransform), and
/// a PointCloud for each channel of shape_observation_t, as far as the selected channels provide
/// them. Throws std::runtime_error.
std::vector<Written> export_mcap(Source& source, const McapOptions& options,
                                 const std::filesystem::path& file);

}  // namespace palpate::exporting
