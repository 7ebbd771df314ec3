#pragma once

#include <array>
#include <memory>
#include <palpate/shape_mesh_t.hpp>
#include <string>
#include <vector>

#include "core/elasticity/element_stress.hpp"

namespace palpate::view {

/// Quantity shown by the colour of a shape.
enum class Field { kDisplacement, kStrain, kStress, kUncertainty };

/// "displacement", "strain", "stress", "uncertainty".
const char* name(Field field);
/// False for an unknown name.
bool field_from(const std::string& name, Field& field);

/// Computes one number per node from the node positions. Elements are tetrahedra between
/// neighbouring nodes with constant strain (those of 10 nodes are divided into 8, the simulator's
/// hexahedra of 27 nodes into 48 each); nodes get the mean of the adjacent elements, weighted by
/// rest volume.
class FieldEvaluator {
 public:
  explicit FieldEvaluator(std::shared_ptr<const shape_mesh_t> mesh);
  ~FieldEvaluator();

  const shape_mesh_t& mesh() const { return *mesh_; }
  /// Whether strain and stress can be computed: there are elements, none of them inverted at rest.
  bool has_elements() const { return !tetrahedra_.empty(); }

  /// |x - x_rest|, m.
  void displacement(const std::vector<float>& xyz, std::vector<float>& out) const;
  /// The largest |principal stretch - 1| of F.
  void strain(const std::vector<float>& xyz, std::vector<float>& out);
  /// Von Mises stress, Pa, of the co-rotated material (core/elasticity).
  void stress(const std::vector<float>& xyz, double young_modulus, double poisson_ratio,
              std::vector<float>& out);

 private:
  struct Tetrahedron {
    std::array<std::int32_t, 4> node;
    Eigen::Matrix3f inverse_edges;  // 1/m: F = edges * this
    float volume = 0;               // m^3, at rest
  };
  struct Mechanics;

  void read_elements();
  void add_tetrahedron(std::array<std::int32_t, 4> node);
  template <class Value>
  void average(Value value_of_element, std::vector<float>& out);

  std::shared_ptr<const shape_mesh_t> mesh_;
  std::vector<Tetrahedron> tetrahedra_;
  std::vector<float> node_volume_;
  std::unique_ptr<Mechanics> mechanics_;
};

}  // namespace palpate::view
