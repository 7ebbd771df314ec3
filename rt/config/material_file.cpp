#include "rt/config/material_file.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace palpate::config {

std::optional<MaterialFile> MaterialFile::read(const Node& object) {
  if (!object.has("material_file")) return std::nullopt;
  const std::string path = object.path(
      {"material_file", "", "Material file of palpate-fit; overrides section material"});
  MaterialFile file(object, Node::load_file(path));
  if (!file.root_.is_mapping("material") || !file.constants().has("model"))
    object.fail("material_file", path +
                                     " is no material as palpate-fit writes it: it has no section "
                                     "material that names a model");
  return file;
}

std::string MaterialFile::model() const { return constants().text("model"); }

Node MaterialFile::corotational() const {
  if (!root_.is_mapping("corotational"))
    holder_.fail("material_file",
                 holder_.path({"material_file", "",
                               "Material file of palpate-fit; overrides section material"}) +
                     " has no section corotational: its recordings do not "
                     "determine Young's modulus");
  return root_.child("corotational");
}

std::optional<double> MaterialFile::largest_strain() const {
  const Node fit = root_.child_or_empty("corotational");
  if (!fit.has("strain_range")) return std::nullopt;
  const std::vector<double> range = fit.numbers("strain_range", 2, {-1, 100});
  const double largest = std::max(std::abs(range[0]), std::abs(range[1]));
  if (largest > 0) return largest;
  return std::nullopt;
}

double MaterialFile::constant(const Key& key, Range range, double otherwise) const {
  return constants().number(key, range, otherwise);
}

Node material_section(const Node& object) {
  return object.has("material_file")
             ? object.child_or_empty({"material", "", "Linear elastic material"})
             : object.child({"material", "", "Linear elastic material"});
}

double material_number(const Node& material, const std::optional<Node>& fitted, const Key& key,
                       Range range) {
  if (!fitted || !fitted->has(key.name)) return material.number(key, range);
  const double found = fitted->number(key, range);
  material.number(key, range, found);
  return found;
}

}  // namespace palpate::config
