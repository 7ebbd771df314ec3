#pragma once

#include <array>

namespace palpate::plugin {

/// Names of built-in components in the slots that accept plug-ins; a plug-in must not use them.
inline constexpr std::array<const char*, 8> kSensorModels = {
    "ft_newton_euler", "ft_rnnob",    "ft_tare_only", "joint_torque",
    "biotac_linear",   "biotac_lstm", "fingertip",    "manual"};
inline constexpr std::array<const char*, 2> kForceTransformers = {"area_coordinates",
                                                                  "wrench_patch"};
inline constexpr std::array<const char*, 5> kEstimators = {
    "pose_driven", "force_driven", "wrench_driven", "fingertip_driven", "pose_wrench_filter"};
inline constexpr std::array<const char*, 6> kDeformationModels = {"corotational_quasistatic",
                                                                  "corotational_dynamic",
                                                                  "hyperelastic",
                                                                  "linear",
                                                                  "mass_spring",
                                                                  "shape_matching"};
inline constexpr std::array<const char*, 7> kFeatures = {
    "point", "points", "pose", "distance", "angle", "curvature", "fourier_contour"};
inline constexpr std::array<const char*, 2> kJacobianProviders = {"fem", "kinematic"};
inline constexpr std::array<const char*, 4> kControlLaws = {"proportional_twist", "dual_quaternion",
                                                            "quadratic_program", "guarded_motion"};

}  // namespace palpate::plugin
