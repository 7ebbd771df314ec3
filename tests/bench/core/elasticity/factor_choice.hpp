#pragma once

#include <string>

#include "core/factor/factor_maker.hpp"

namespace palpate::bench {

/// "own", or "cholmod" in a build with SuiteSparse; throws std::invalid_argument otherwise.
factor::FactorMaker factor_maker(const std::string& name);

}  // namespace palpate::bench
