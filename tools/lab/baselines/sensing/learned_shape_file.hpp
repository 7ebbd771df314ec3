#pragma once

#include <string>

#include "tools/lab/baselines/sensing/learned_shape.hpp"

namespace palpate::baselines {

/// Reads a model written by palpate-evaluate train-sensing, YAML. Throws config::Error with file
/// and key.
LearnedShape::Model read_learned_shape(const std::string& file);

}  // namespace palpate::baselines
