#include "sim/sensors/fingertip_sensor.hpp"

#include "core/math/constants.hpp"
#include "core/sensing/biotac_geometry.hpp"

namespace palpate::sensors {

FingertipSensor::FingertipSensor(const FingertipTable& table, double period,
                                 const math::Random& random)
    : table_(table),
      place_(table.place, period, Eigen::Vector3d::Zero(), random.split("place")),
      force_(table.force, period, Eigen::Vector3d::Zero(), random.split("force")) {}

FingertipReading FingertipSensor::read(const std::vector<Touch>& touches) {
  FingertipReading r;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero(), on_finger = Eigen::Vector3d::Zero();
  double weight = 0;
  for (const Touch& touch : touches) {
    const double size = touch.force_T.norm();
    centre += size * touch.location_T;
    on_finger += touch.force_T;
    weight += size;
    r.area += math::kPi * touch.radius * touch.radius;
  }
  r.force = force_.measure(-on_finger);
  r.place_deviation = table_.place.noise;
  r.force_deviation = table_.force.noise;
  r.contact = weight > 0;
  if (!r.contact) return r;
  r.place = sensing::project_on_skin(place_.measure(centre / weight));
  r.normal = sensing::skin_normal(r.place);
  return r;
}

}  // namespace palpate::sensors
