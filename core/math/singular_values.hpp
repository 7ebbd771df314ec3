#pragma once

#include <Eigen/SVD>

// Instantiated once, in singular_values.cpp, because it takes longer to compile than most sources.
extern template class Eigen::JacobiSVD<Eigen::MatrixXd>;
