// Cholesky factor of A restricted to the clamped contacts, grown and shrunk one row at a time.
// Source: P. E. Gill, G. H. Golub, W. Murray, M. A. Saunders, Methods for modifying matrix
// factorizations, Math. Comp. 28 (1974): appending and deleting a row.
#pragma once

#include <Eigen/Core>

namespace ourengine::baraff {

class ClampedFactor {
 public:
  explicit ClampedFactor(Eigen::Index capacity) : lower_(capacity, capacity) {}

  Eigen::Index size() const { return size_; }
  // y with L y = column, (size).
  Eigen::VectorXd forward(const Eigen::VectorXd& column) const;
  // x with L^T x = y, (size).
  Eigen::VectorXd backward(const Eigen::VectorXd& y) const;
  // Appends a row whose forward() is y and whose Schur pivot is `pivot` > 0.
  void append(const Eigen::VectorXd& y, double pivot);
  void remove(Eigen::Index row);

 private:
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> lower_;
  Eigen::Index size_ = 0;
};

}  // namespace ourengine::baraff
