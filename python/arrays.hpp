// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <pybind11/numpy.h>

#include "gatefly/detection/quad.hpp"

namespace gatefly::python {

/// A copy as a numpy array; a column is one-dimensional.
template <class Derived>
pybind11::array_t<double> array_of(const Eigen::MatrixBase<Derived>& matrix) {
  using Shape = std::vector<pybind11::ssize_t>;
  const bool is_column = matrix.cols() == 1;
  pybind11::array_t<double> array(is_column ? Shape{matrix.rows()}
                                            : Shape{matrix.rows(), matrix.cols()});
  double* to = array.mutable_data();
  for (Eigen::Index row = 0; row < matrix.rows(); ++row)
    for (Eigen::Index column = 0; column < matrix.cols(); ++column) *to++ = matrix(row, column);
  return array;
}

inline pybind11::array_t<double> array_of(const Quad& quad) {
  Eigen::Matrix<double, 4, 2> corners;
  for (Eigen::Index i = 0; i < 4; ++i)
    corners.row(i) = quad[static_cast<std::size_t>(i)].transpose();
  return array_of(corners);
}

}  // namespace gatefly::python
