#include "libcore/check/random_hand.hpp"

#include <cmath>

namespace hapgrid {

namespace {
// The most legs straight on: eight cells.
constexpr std::uint64_t kMostLegs = 16;
}  // namespace

PointIndex RandomHand::jump() {
  const auto point = static_cast<PointIndex>(random_.below(box_.points()));
  at_ = box_.position(point);
  return point;
}

void RandomHand::set_out() {
  if (left_ == 0) {
    left_ = 1 + random_.below(kMostLegs);
    turn();
  }
  --left_;
}

void RandomHand::step() {
  for (int a = 0; a < 3; ++a) {
    const double last = box_.origin[a] + box_.spacing * (box_.counts[a] - 1);
    const auto leaves = [&] {
      const double next = at_[a] + length_ * towards_[a];
      return next < box_.origin[a] || next > last;
    };
    if (leaves()) towards_[a] = -towards_[a];
    if (!leaves()) at_[a] += length_ * towards_[a];
  }
}

/// A direction, each as likely as any other; along flat axes nothing moves. Steps of one length
/// would meet the same places of each cell again on a way along an axis.
void RandomHand::turn() {
  double squares = 0;
  do {
    squares = 0;
    for (int a = 0; a < 3; ++a) {
      towards_[a] = box_.counts[a] > 1 ? 2 * random_.part() - 1 : 0;
      squares += towards_[a] * towards_[a];
    }
  } while (squares > 1 || squares < 0.01);
  for (double& component : towards_) component /= std::sqrt(squares);
  length_ = box_.spacing / (2 * steps_) * (1 + random_.part()) / 2;
}

}  // namespace hapgrid
