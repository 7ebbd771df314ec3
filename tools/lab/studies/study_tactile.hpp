#pragma once

#include <nlohmann/json_fwd.hpp>

#include "tools/lab/studies/study_score.hpp"
#include "tools/lab/studies/study_tables.hpp"

namespace palpate::studies {

/// What a depth camera measures of the true shape, 0.8 m away and above the object's side, and how
/// the virtual camera's clouds of estimate and truth, from the same place, agree with it by octree
/// (thesis Figs 4.7 to 4.11). The hand is not in the picture.
struct CameraAgreement {
  Eigen::Matrix3Xd measured;         // in O, m
  scores::OctreeAgreement estimate;  // its `truth` is the measured cloud
  scores::OctreeAgreement truth;  // the same of the true shape: what noise and cubes leave to reach
};
CameraAgreement camera_agreement(const StateShapes& shapes, const math::Pose& X_WO,
                                 double resolution, int seed);

/// Adds the camera's agreement and, by finger, the errors of force and place over the last half
/// second to the JSON of a state at `utime`; shapes.measured becomes the measured cloud. Without a
/// renderer the cloud is left out.
void add_tactile_score(const StudyJob& job, const log::RunLog& log, const math::Pose& X_WO,
                       std::int64_t utime, StateShapes& shapes, nlohmann::json& json);

/// Agreement with the camera's cloud and contact forces: a row a state and method.
ReportTable tactile_table(const StudyApplication& application,
                          const std::vector<StudyResult>& results);

}  // namespace palpate::studies
