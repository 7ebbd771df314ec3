#include "core/math/rigid.hpp"
