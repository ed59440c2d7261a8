#include "ourengine/baraff/clamped_factor.hpp"

#include <cmath>
#include <vector>

namespace ourengine::baraff {

Eigen::VectorXd ClampedFactor::forward(const Eigen::VectorXd& column) const {
  Eigen::VectorXd y = column;
  for (Eigen::Index i = 0; i < size_; ++i) {
    y[i] = (y[i] - lower_.row(i).head(i).dot(y.head(i))) / lower_(i, i);
  }
  return y;
}

Eigen::VectorXd ClampedFactor::backward(const Eigen::VectorXd& y) const {
  Eigen::VectorXd x = y;
  for (Eigen::Index i = size_; i-- > 0;) {
    x[i] /= lower_(i, i);
    x.head(i) -= x[i] * lower_.row(i).head(i).transpose();
  }
  return x;
}

void ClampedFactor::append(const Eigen::VectorXd& y, double pivot) {
  lower_.row(size_).head(size_) = y.transpose();
  lower_(size_, size_) = std::sqrt(pivot);
  ++size_;
}

void ClampedFactor::remove(Eigen::Index row) {
  struct Turn {
    double c, s;
  };
  std::vector<Turn> turns;
  // Row i of the new factor is row i + 1 of the old one, with one entry too many on the right.
  for (Eigen::Index i = row; i + 1 < size_; ++i) {
    lower_.row(i).head(i + 2) = lower_.row(i + 1).head(i + 2);
    double* entry = &lower_(i, row);
    for (const Turn& turn : turns) {
      const double left = entry[0];
      const double right = entry[1];
      entry[0] = turn.c * left + turn.s * right;
      entry[1] = turn.c * right - turn.s * left;
      ++entry;
    }
    const double length = std::hypot(entry[0], entry[1]);
    turns.push_back({entry[0] / length, entry[1] / length});
    entry[0] = length;
  }
  --size_;
}

}  // namespace ourengine::baraff
