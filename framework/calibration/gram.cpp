#include "framework/calibration/gram.h"

#include <Eigen/QR>
#include <algorithm>
#include <xsimd/xsimd.hpp>

namespace talus {
namespace {

using V = xsimd::batch<double>;

// Sixteen sums of products of four columns with four columns.
inline void block(const double* const* a, const double* const* b, std::size_t length,
                  double out[4][4]) {
  V s[4][4];
  for (auto& row : s)
    for (V& v : row) v = V(0.0);
  for (std::size_t k = 0; k < length; k += V::size) {
    const V b0 = V::load_aligned(b[0] + k), b1 = V::load_aligned(b[1] + k);
    const V b2 = V::load_aligned(b[2] + k), b3 = V::load_aligned(b[3] + k);
    for (int i = 0; i < 4; ++i) {
      const V x = V::load_aligned(a[i] + k);
      s[i][0] = xsimd::fma(x, b0, s[i][0]);
      s[i][1] = xsimd::fma(x, b1, s[i][1]);
      s[i][2] = xsimd::fma(x, b2, s[i][2]);
      s[i][3] = xsimd::fma(x, b3, s[i][3]);
    }
  }
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) out[i][j] = xsimd::hadd(s[i][j]);
}

}  // namespace

void add_gram(const double* A, int columns, std::size_t stride, std::size_t length,
              Eigen::MatrixXd& G) {
  for (int i = 0; i < columns; i += 4)
    for (int j = i; j < columns; j += 4) {
      const double *a[4], *b[4];
      for (int k = 0; k < 4; ++k) a[k] = A + (i + k) * stride, b[k] = A + (j + k) * stride;
      double sums[4][4];
      block(a, b, length, sums);
      for (int p = 0; p < 4 && i + p < columns; ++p)
        for (int q = 0; q < 4 && j + q < columns; ++q)
          if (i + p <= j + q) G(i + p, j + q) += sums[p][q];
    }
}

void add_qr(const double* A, int columns, std::size_t stride, std::size_t length,
            Eigen::MatrixXd& R) {
  const auto rows = static_cast<Eigen::Index>(length);
  Eigen::MatrixXd stacked(columns + rows, columns);
  stacked.topRows(columns) = R.triangularView<Eigen::Upper>();
  for (int c = 0; c < columns; ++c)
    stacked.col(c).tail(rows) = Eigen::Map<const Eigen::VectorXd>(A + c * stride, rows);
  Eigen::HouseholderQR<Eigen::Ref<Eigen::MatrixXd>> qr(stacked);
  R = stacked.topRows(columns).triangularView<Eigen::Upper>();
}

}  // namespace talus
