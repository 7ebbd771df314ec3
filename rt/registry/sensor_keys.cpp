#include "rt/registry/sensor_keys.hpp"

#include <vector>

namespace palpate::registry {

int read_polarity(const config::Node& node) {
  const int polarity = node.integer({"polarity", "",
                                     "-1 for a sensor that reports what the load exerts on it, or "
                                     "whose counts fall under pressure; else 1"},
                                    {-1, 1}, 1);
  if (polarity == 0) node.fail("polarity", "must be -1 or 1");
  return polarity;
}

sensing::PayloadParameters read_payload(const config::Node& node) {
  const config::Node payload = node.child({"payload", "",
                                           "what the sensor carries, as palpate-evaluate payload "
                                           "identifies it; ft_newton_euler needs it"});
  sensing::PayloadParameters parameters;
  parameters.mass = payload.number({"mass", "kg", "behind the sensor"}, {0, 1000});
  parameters.first_moment = parameters.mass * payload.vector3({"center_of_mass", "m", "in S"},
                                                              {-2, 2}, Eigen::Vector3d::Zero());
  parameters.inertia = sensing::point_inertia(parameters.mass, parameters.first_moment);
  if (payload.has("inertia")) {
    const std::vector<double> inertia = payload.numbers(
        {"inertia", "kg m^2",
         "xx, xy, xz, yy, yz, zz about the origin of S; absent: that of a point at center_of_mass"},
        6, {-100, 100});
    parameters.inertia = Eigen::Map<const math::Vector6d>(inertia.data());
  }
  if (payload.has("bias")) {
    const std::vector<double> bias =
        payload.numbers({"bias", "N, N m", "that the sensor adds, force first"}, 6, {-1000, 1000});
    parameters.bias = math::Wrench::from(Eigen::Map<const math::Vector6d>(bias.data()));
  }
  return parameters;
}

sensing::LocalizationOptions read_localization(const config::Node& node) {
  sensing::LocalizationOptions options;
  options.polarity = read_polarity(node);
  options.threshold = node.number({"threshold", "counts", "beyond which an electrode is active"},
                                  {0, 4095}, options.threshold);
  options.saturation = node.number({"saturation", "counts", "that make full intensity"}, {1, 4095},
                                   options.saturation);
  if (node.choice(
          {"weighting", "",
           "how the intensities place the contact: their centroid, or as published in the thesis"},
          {"centroid", "published"}, "centroid") == "published")
    options.weighting = sensing::Weighting::kPublished;
  return options;
}

}  // namespace palpate::registry
