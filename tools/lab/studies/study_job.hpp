#pragma once

#include <filesystem>
#include <string>

#include "tools/lab/studies/study_plan.hpp"

namespace palpate::studies {

/// Runs one job: simulator and daemon in lock-step, or in real time where the job says so; scores
/// it on the plant's truth; leaves pictures, what the programs printed and result.json, which
/// carries `inputs_hash`, in `folder`. The logs go once they are scored, unless `keep_logs`. Throws
/// RunFailed and whatever scoring throws, leaving the logs.
void run_study_job(const StudyJob& job, const std::string& inputs_hash,
                   const std::filesystem::path& folder, bool keep_logs);

}  // namespace palpate::studies
