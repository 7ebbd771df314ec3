#pragma once

#include <filesystem>
#include <string>

#include "tools/lab/studies/study_plan.hpp"

namespace palpate::studies {

/// Runs one job: simulator and daemon in lock-step, or in real time if the job requests it; scores
/// it on the plant's ground truth; leaves images, the programs' output and result.json, which
/// carries `inputs_hash`, in `folder`. The logs are deleted once scored, unless `keep_logs`. Throws
/// RunFailed and any exception of scoring; the logs are then kept.
void run_study_job(const StudyJob& job, const std::string& inputs_hash,
                   const std::filesystem::path& folder, bool keep_logs);

}  // namespace palpate::studies
