#include "experiments/exact/schemes/pivoting.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <limits>

namespace brickbench::exact {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd pivot_in_order(const MatrixXd& a, const VectorXd& b) {
  const Index n = b.size();
  VectorXd x = VectorXd::Zero(n);
  std::vector<Index> pushing;  // w = 0, x >= 0
  std::vector<bool> pushes(static_cast<std::size_t>(n), false);
  const auto flag = [&](Index i) -> std::vector<bool>::reference {
    return pushes[static_cast<std::size_t>(i)];
  };
  for (Index i = 0; i < n; ++i) {
    for (;;) {
      const VectorXd w = a * x - b;
      if (w[i] >= 0.0) break;
      pushing.clear();
      for (Index k = 0; k < i; ++k) {
        if (flag(k)) pushing.push_back(k);
      }
      VectorXd dx = VectorXd::Unit(n, i);
      if (!pushing.empty()) {
        const MatrixXd held = a(pushing, pushing);
        const VectorXd pull = a(pushing, std::vector<Index>{i}).col(0);
        const VectorXd answer = held.ldlt().solve(-pull);
        dx(pushing) = answer;
      }
      const VectorXd dw = a * dx;
      double length = -w[i] / dw[i];
      Index change = i;
      for (Index k = 0; k < i; ++k) {
        const double limit = flag(k)       ? (dx[k] < 0.0 ? -x[k] / dx[k] : length)
                             : dw[k] < 0.0 ? -w[k] / dw[k]
                                           : length;
        if (limit < length) {
          length = limit;
          change = k;
        }
      }
      if (!(length > 0.0)) {
        x.tail(n - i).setZero();
        return x;
      }
      x += length * dx;
      flag(change) = change == i || !flag(change);
      if (!flag(change)) x[change] = 0.0;
      if (change == i) break;
    }
  }
  return x;
}

std::vector<std::size_t> island_order(const World& world, std::span<const PointContact> contacts) {
  std::vector<std::size_t> order;
  std::vector<bool> met(contacts.size(), false), visited(world.bodies.size(), false);
  for (std::size_t start = world.bodies.size(); start-- > 0;) {
    if (world.bodies[start].fixed || visited[start]) continue;
    std::vector<std::size_t> stack = {start};
    visited[start] = true;
    while (!stack.empty()) {
      const std::size_t body = stack.back();
      stack.pop_back();
      for (std::size_t c = contacts.size(); c-- > 0;) {
        const PointContact& contact = contacts[c];
        if (met[c] || (contact.body_a != body && contact.body_b != body)) continue;
        met[c] = true;
        order.push_back(c);
        const std::size_t other = contact.body_a == body ? contact.body_b : contact.body_a;
        if (world.bodies[other].fixed || visited[other]) continue;
        visited[other] = true;
        stack.push_back(other);
      }
    }
  }
  return order;
}

}  // namespace brickbench::exact
