#include "tools/fit/held/held_cell.hpp"

#include "rt/registry/sensors.hpp"

namespace palpate::fit {

HeldCell read_held_cell(const std::string& configuration,
                        const std::vector<std::string>& overrides) {
  const config::Node root = config::Node::load_file(configuration, overrides);
  HeldCell cell;
  cell.frames = registry::read_frames(root);
  cell.object = registry::read_object(root, cell.frames);
  if (cell.object.body.grasps.size() != 1)
    root.child("object").fail("grasp_box", "one hand must hold the object, not two or none");
  for (const config::Node& sensor : root.list("sensing")) {
    if (sensor.text("component").rfind("ft_", 0) != 0) continue;
    if (sensor.has("payload")) cell.hand = registry::read_payload(sensor);
    cell.polarity = sensor.integer("polarity", {-1, 1}, 1);
    break;
  }
  return cell;
}

}  // namespace palpate::fit
