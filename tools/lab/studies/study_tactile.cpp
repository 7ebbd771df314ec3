#include "tools/lab/studies/study_tactile.hpp"

#include <iostream>
#include <nlohmann/json.hpp>

#include "core/math/random.hpp"
#include "sim/camera/shape_camera.hpp"
#include "sim/draw/view.hpp"
#include "tools/common/table.hpp"
#include "tools/lab/scores/cloud_view.hpp"
#include "tools/log/plant_truth.hpp"

namespace palpate::studies {
namespace {

using Eigen::Vector3d;
using Json = nlohmann::json;

constexpr int kFirstFinger = 2;  // of contacts_t::source
constexpr int kFingers = 5;
constexpr const char* kNames[kFingers] = {"first", "middle", "ring", "little", "thumb"};
constexpr std::int64_t kStudyTactileWindow = 500'000;  // us before a state
const Vector3d kEye(-0.25, -0.65, 0.40);               // m, in W, from the middle of the object
constexpr int kMostPoints = 20000;

draw::TriangleMesh in_world(const draw::TriangleMesh& mesh_O, const math::Pose& X_WO) {
  return {log::transformed(X_WO, mesh_O.points), mesh_O.triangles};
}

struct FingerErrors {
  int count = 0;
  double force = 0, force_error = 0, place_error = 0;  // N, N, m; sums
};

/// palpated's estimate for a finger compared with its true contact; empty if only one of them has
/// contact.
void add_errors(const truth_touch_t& truth, const contacts_t& felt,
                std::array<FingerErrors, kFingers>& errors) {
  for (int i = 0; i < felt.count; ++i) {
    const int finger = felt.source[i] - kFirstFinger;
    if (finger < 0 || finger >= kFingers || truth.contact[finger] == truth_touch_t::NONE) continue;
    const Eigen::Map<const Vector3d> force(truth.force[finger]), place(truth.position[finger]);
    FingerErrors& e = errors[finger];
    ++e.count;
    e.force += force.norm();
    e.force_error += (Eigen::Map<const Vector3d>(felt.wrench[i]) - force).norm();
    e.place_error += (Eigen::Map<const Vector3d>(felt.location[i]) - place).norm();
  }
}

/// Mean over the seeds of a number in a state's JSON.
std::string cell(const std::vector<const Json*>& states, const std::string& key, double scale,
                 int decimals) {
  std::vector<double> values;
  for (const Json* state : states)
    if (state->contains(key)) values.push_back(scale * state->at(key).get<double>());
  return values.empty() ? "" : common::median_and_interval(values, decimals);
}

}  // namespace

CameraAgreement camera_agreement(const StateShapes& shapes, const math::Pose& X_WO,
                                 double resolution, int seed) {
  const draw::TriangleMesh truth_W = in_world(shapes.truth, X_WO);
  const Vector3d middle = truth_W.points.rowwise().mean();
  camera::ShapeCameraOptions options;
  options.X_WC = draw::look_at(middle + kEye, middle, Vector3d::UnitZ());
  options.segmentation = camera::Segmentation::kTruth;
  options.voxel = 0.25 * resolution;
  camera::Body body;
  body.mesh = std::make_shared<const draw::TriangleMesh>(truth_W);
  body.is_object = true;
  const math::Pose X_OW = X_WO.inverse();
  CameraAgreement result;
  {
    camera::ShapeCamera camera(options);
    result.measured = log::transformed(
        X_OW, camera.look({body}, math::Random(seed, "thesis camera"), kMostPoints).points_W);
  }
  camera::DepthCamera virtual_camera;
  const auto agreement = [&](const draw::TriangleMesh& mesh_W) {
    const Eigen::Matrix3Xd cloud = scores::virtual_cloud(virtual_camera, options.X_WC, mesh_W);
    return scores::octree_agreement(log::transformed(X_OW, cloud), result.measured, resolution);
  };
  result.estimate = agreement(in_world(shapes.estimate, X_WO));
  result.truth = agreement(truth_W);
  return result;
}

void add_tactile_score(const StudyJob& job, const log::RunLog& log, const math::Pose& X_WO,
                       std::int64_t utime, StateShapes& shapes, nlohmann::json& json) {
  try {
    const CameraAgreement seen = camera_agreement(shapes, X_WO, job.octree_resolution, job.seed);
    shapes.measured = seen.measured;
    shapes.camera = true;
    json["measured"] = "rendered camera";
    json["octree_camera_in_estimate"] = seen.estimate.truth_in_estimate;
    json["octree_estimate_in_camera"] = seen.estimate.estimate_in_truth;
    json["octree_camera_in_true_shape"] = seen.truth.truth_in_estimate;
    json["octree_true_shape_in_camera"] = seen.truth.estimate_in_truth;
  } catch (const std::exception& error) {
    std::cout << "no camera's cloud of " << json.value("name", "") << ": " << error.what() << '\n';
  }
  std::array<FingerErrors, kFingers> errors;
  for (const truth_touch_t& truth : log.truth_touches) {
    if (truth.utime <= utime - kStudyTactileWindow || truth.utime > utime) continue;
    if (const contacts_t* felt = log::latest(log.contacts, truth.utime))
      add_errors(truth, *felt, errors);
  }
  for (int finger = 0; finger < kFingers; ++finger) {
    const FingerErrors& e = errors[finger];
    if (e.count == 0) continue;
    const std::string name = std::string("finger_") + kNames[finger];
    json[name + "_force_n"] = e.force / e.count;
    json[name + "_force_error_n"] = e.force_error / e.count;
    json[name + "_place_error_mm"] = 1e3 * e.place_error / e.count;
  }
}

ReportTable tactile_table(const StudyApplication& application,
                          const std::vector<StudyResult>& results) {
  ReportTable table{
      {"method", "camera in estimate %", "(in true shape)", "estimate in camera %", "(true shape)"},
      {}};
  for (const char* name : kNames)
    for (const char* what : {" N", ": off by N", "place mm"})
      table.header.push_back(std::string(name) + (what[0] == 'p' ? " " : "") + what);
  for (const StudyState& wanted : application.states) {
    table.rows.push_back({wanted.name});
    for (const runs::Method& method : application.methods) {
      std::vector<const Json*> states;
      for (const StudyResult& result : results) {
        if (result.job.application != application.name || result.job.method != method.name ||
            !result.json.is_object() || !result.json.contains("states"))
          continue;
        for (const Json& state : result.json["states"])
          if (state.value("name", "") == wanted.name) states.push_back(&state);
      }
      std::vector<std::string> row{method.name, cell(states, "octree_camera_in_estimate", 100, 1),
                                   cell(states, "octree_camera_in_true_shape", 100, 1),
                                   cell(states, "octree_estimate_in_camera", 100, 1),
                                   cell(states, "octree_true_shape_in_camera", 100, 1)};
      for (const char* name : kNames) {
        const std::string key = std::string("finger_") + name;
        row.push_back(cell(states, key + "_force_n", 1, 2));
        row.push_back(cell(states, key + "_force_error_n", 1, 3));
        row.push_back(cell(states, key + "_place_error_mm", 1, 2));
      }
      table.rows.push_back(row);
    }
  }
  return table;
}

}  // namespace palpate::studies
