// The paths of bench_branches: where a hand goes.
#pragma once

#include <array>
#include <deque>
#include <map>
#include <numbers>

#include "libcore/base/error.hpp"
#include "libcore/grid/vec3.hpp"
#include "tests/bench/bench.hpp"

namespace hapgrid::bench {

/// Ticks of a way of the kind `back`.
inline constexpr std::size_t kLeg = 40;

/// By kind, as bench_branches names them.
class Paths {
 public:
  /// @param force at the grid's records, newtons @param ticks the least of a path
  Paths(const Grid& grid, const std::vector<Vec3>& force, std::string kind, double ticks_a_cell,
        std::size_t ticks)
      : grid_(grid),
        box_(grid.box()),
        kind_(std::move(kind)),
        ticks_a_cell_(ticks_a_cell),
        ticks_(ticks) {
    for (RecordIndex r = 0; r < grid.records(); ++r) {
      const double newtons = distance(force[r], {0, 0, 0});
      if (newtons >= 0.02 && newtons <= 2.5) touched_.push_back(grid.point(r));
    }
    if (touched_.empty()) throw Error("this grid has nothing to touch");
    if (kind_ != "tear-off") return;
    for (RecordIndex r = 0; r < grid.records(); ++r)
      for (int q = 0; q < kDirections; ++q)
        if (grid.is_one_way(r, q)) tears_.push_back({r, q});
    if (tears_.empty()) throw Error("this grid has no one-way link");
  }

  std::vector<Vec3> make(std::uint64_t seed) const {
    std::mt19937_64 random(seed);
    if (kind_ == "smooth") return smooth(random);
    if (kind_ == "touch") return touch(random);
    if (kind_ == "back") return there_and_back(touch(random));
    if (kind_ == "tear-off") return to_a_tear(random);
    Vec3 from = place(random), to = place(random);
    if (kind_ == "straight") {
      to = from;
      from[0] = box_.origin[0];
      to[0] = box_.origin[0] + box_.spacing * (box_.counts[0] - 1);
    }
    std::vector<Vec3> path;
    while (path.size() < ticks_) {
      go(path, from, to);
      go(path, to, from);
    }
    return path;
  }

 private:
  Vec3 place(std::mt19937_64& random) const {
    Vec3 x;
    for (int a = 0; a < 3; ++a)
      x[a] = box_.origin[a] + box_.spacing * (box_.counts[a] - 1) * uniform(random, 0.05, 0.95);
    return x;
  }

  void go(std::vector<Vec3>& path, const Vec3& from, const Vec3& to) const {
    const double way = distance(to, from);
    const double ticks = std::ceil(way / box_.spacing * ticks_a_cell_);
    for (double i = 0; i < ticks; ++i) {
      Vec3 x;
      for (int a = 0; a < 3; ++a) x[a] = from[a] + i / ticks * (to[a] - from[a]);
      path.push_back(x);
    }
  }

  std::vector<Vec3> smooth(std::mt19937_64& random) const {
    constexpr int kSines = 3;
    double phase[3][kSines], rate[3][kSines];
    for (int a = 0; a < 3; ++a)
      for (int i = 0; i < kSines; ++i) {
        phase[a][i] = uniform(random, 0, 2 * std::numbers::pi);
        rate[a][i] = uniform(random, 0.5, 1 + i);
      }
    const auto at = [&](double t) {
      Vec3 x;
      for (int a = 0; a < 3; ++a) {
        double s = 0;
        for (int i = 0; i < kSines; ++i) s += std::sin(rate[a][i] * t + phase[a][i]) / kSines;
        x[a] = box_.origin[a] +
               box_.spacing * (box_.counts[a] - 1) * (0.5 + 0.45 * std::clamp(1.5 * s, -1.0, 1.0));
      }
      return x;
    };
    std::vector<Vec3> path;
    double t = 0;
    while (path.size() < ticks_) {
      path.push_back(at(t));
      const Vec3 now = at(t), soon = at(t + 1e-4);
      const double speed = distance(soon, now) / 1e-4;
      t += std::min(0.05, box_.spacing / ticks_a_cell_ / std::max(speed, 1e-9));
    }
    return path;
  }

  /// A uniform cubic B-spline through the places where the model pushes, each moved by up to 0.7
  /// spacings along each axis.
  std::vector<Vec3> touch(std::mt19937_64& random) const {
    const auto place = [&] {
      Vec3 x = box_.position(touched_[random() % touched_.size()]);
      for (int a = 0; a < 3; ++a) {
        const double high = box_.origin[a] + box_.spacing * (box_.counts[a] - 1);
        x[a] += box_.spacing * uniform(random, -0.7, 0.7);
        x[a] = std::clamp(x[a], box_.origin[a], high);
      }
      return x;
    };
    std::array<Vec3, 4> p{place(), place(), place(), place()};
    const auto at = [&](double t) {
      const double w[] = {(1 - t) * (1 - t) * (1 - t) / 6, (3 * t * t * t - 6 * t * t + 4) / 6,
                          (-3 * t * t * t + 3 * t * t + 3 * t + 1) / 6, t * t * t / 6};
      return w[0] * p[0] + w[1] * p[1] + w[2] * p[2] + w[3] * p[3];
    };
    std::vector<Vec3> path;
    while (path.size() < ticks_) {
      for (double t = 0; t < 1;) {
        path.push_back(at(t));
        const double speed = distance(at(t + 1e-4), at(t)) / 1e-4;
        t += std::min(0.05, box_.spacing / ticks_a_cell_ / std::max(speed, 1e-9));
      }
      p = {p[1], p[2], p[3], place()};
    }
    return path;
  }

  /// Each piece of a path of kLeg ticks there, back, and there again.
  static std::vector<Vec3> there_and_back(const std::vector<Vec3>& path) {
    std::vector<Vec3> ways;
    for (std::size_t i = 0; i + kLeg <= path.size(); i += kLeg)
      for (int way = 0; way < 3; ++way)
        for (std::size_t j = 0; j < kLeg; ++j)
          ways.push_back(path[way == 1 ? i + kLeg - 1 - j : i + j]);
    return ways;
  }

  /// The way along two-way links from a point with one level to a record, or nothing.
  std::vector<RecordIndex> way_to(RecordIndex record) const {
    std::map<RecordIndex, RecordIndex> before{{record, record}};
    std::deque<RecordIndex> queue{record};
    while (!queue.empty()) {
      RecordIndex r = queue.front();
      queue.pop_front();
      if (grid_.levels(grid_.point(r)) == 1) {
        std::vector<RecordIndex> way{r};
        while (r != record) way.push_back(r = before[r]);
        return way;
      }
      for (int q = 0; q < kDirections; ++q) {
        const RecordIndex to = grid_.destination(r, q);
        if (to != Grid::kNoRecord && !grid_.is_one_way(r, q) && before.try_emplace(to, r).second)
          queue.push_back(to);
      }
    }
    return {};
  }

  std::vector<Vec3> to_a_tear(std::mt19937_64& random) const {
    std::vector<Vec3> path;
    std::vector<RecordIndex> way;
    Tear tear{};
    while (way.empty()) {
      tear = tears_[random() % tears_.size()];
      way = way_to(tear.from);
    }
    Vec3 at = box_.position(grid_.point(way.front()));
    for (const RecordIndex r : way) {
      const Vec3 to = box_.position(grid_.point(r));
      go(path, at, to);
      at = to;
    }
    const Vec3 from = at;
    for (int leg = 0; leg < 40; ++leg) {
      Vec3 to;
      for (int a = 0; a < 3; ++a) {
        to[a] = from[a] + 0.5 * grid_.neighbourhood().shift(tear.q)[a] +
                box_.spacing * uniform(random, -2, 2);
        to[a] =
            std::clamp(to[a], box_.origin[a], box_.origin[a] + box_.spacing * (box_.counts[a] - 1));
      }
      go(path, at, to);
      at = to;
    }
    return path;
  }

  struct Tear {
    RecordIndex from;
    int q;
  };
  const Grid& grid_;
  const Box& box_;
  std::string kind_;
  double ticks_a_cell_;
  std::size_t ticks_;
  std::vector<PointIndex> touched_;
  std::vector<Tear> tears_;
};

}  // namespace hapgrid::bench
