// Sums over many rows without keeping them. A panel is a block of columns [J r], each contiguous
// and aligned; what the solver needs of it is either the Gram matrix [J r]^T [J r] (fast) or the
// triangular factor of a QR decomposition (does not square the condition number).
#pragma once

#include <Eigen/Core>
#include <cstddef>

namespace talus {

// Columns are handled four at a time: panels are allocated with this many.
inline int padded(int columns) { return (columns + 3) / 4 * 4; }

// G (columns x columns, upper triangle) += A^T A, where A's column c starts at A + c * stride and
// has `length` entries, a multiple of 16. A must have padded(columns) columns; the padding is
// ignored.
void add_gram(const double* A, int columns, std::size_t stride, std::size_t length,
              Eigen::MatrixXd& G);

// R (upper triangular) <- factor of [R; A], so that R^T R grows by A^T A.
void add_qr(const double* A, int columns, std::size_t stride, std::size_t length,
            Eigen::MatrixXd& R);

}  // namespace talus
