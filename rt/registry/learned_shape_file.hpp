#pragma once

#include <string>

#include "core/published_sensing/learned_shape.hpp"

namespace palpate::registry {

/// Reads a model written by palpate-evaluate train-sensing, YAML. Throws config::Error with file
/// and key.
published_sensing::LearnedShape::Model read_learned_shape(const std::string& file);

}  // namespace palpate::registry
