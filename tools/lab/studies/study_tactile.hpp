#pragma once

#include <nlohmann/json_fwd.hpp>

#include "tools/lab/studies/study_score.hpp"
#include "tools/lab/studies/study_tables.hpp"

namespace palpate::studies {

/// Measurement of the true shape by a depth camera, 0.8 m away and above the object's side, and
/// agreement by octree with the virtual camera's clouds of estimate and truth, from the same pose
/// (thesis Figs 4.7 to 4.11). The hand is not rendered.
struct CameraAgreement {
  Eigen::Matrix3Xd measured;         // in O, m
  scores::OctreeAgreement estimate;  // its `truth` is the measured cloud
  scores::OctreeAgreement truth;     // the same of the true shape: the bound set by noise and cubes
};
CameraAgreement camera_agreement(const StateShapes& shapes, const math::Pose& X_WO,
                                 double resolution, int seed);

/// Adds the camera's agreement and, by finger, the errors of force and contact point over the last
/// half second to the JSON of a state at `utime`; shapes.measured becomes the measured cloud.
/// Without a renderer the cloud is omitted.
void add_tactile_score(const StudyJob& job, const log::RunLog& log, const math::Pose& X_WO,
                       std::int64_t utime, StateShapes& shapes, nlohmann::json& json);

/// Agreement with the camera's cloud and contact forces: one row per state and method.
ReportTable tactile_table(const StudyApplication& application,
                          const std::vector<StudyResult>& results);

}  // namespace palpate::studies
