#pragma once

#include "rt/plugin/plugin.hpp"

namespace example {

/// Example of a user's force transformer: the force of a contact is divided among the nodes nearest
/// to its place, in inverse proportion to their distance. Its torque is not kept.
class NearestNodes : public palpate::plugin::PluginForceTransformer {
 public:
  static constexpr int kMostNodes = 16;
  struct Options {
    int nodes = 4;
    double reach = 0.05;  // m, distance of the nearest node beyond which a contact is rejected
  };
  static palpate::config::OptionTable<Options> table();

  NearestNodes(const Options& options, const palpate::elasticity::Body& body);

  int max_nodes() const override { return options_.nodes; }
  void distribute(const palpate::sensing::Contact& contact, const Eigen::Matrix3Xd& positions,
                  palpate::contact::ContactLoads& out) override;

 private:
  Options options_;
};

}  // namespace example
