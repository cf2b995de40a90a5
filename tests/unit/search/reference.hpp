// Algorithm 1 of the paper, line by line, with a map for X and a sorted vector for Q. It shares no
// code with libcore: the points, directions and the order are written down here once more.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <tuple>
#include <utility>
#include <vector>

#include "tests/unit/search/toy.hpp"

namespace reference {

struct Record {
  std::vector<double> s;
  std::array<int, 26> D;
  unsigned generation;
  friend bool operator==(const Record&, const Record&) = default;
};

/// By (point, level).
using X = std::map<std::pair<std::uint64_t, int>, Record>;

struct Grid {
  std::array<double, 3> origin;
  double spacing;
  std::array<int, 3> counts;
};

struct Request {
  std::uint64_t source;
  int level;
  int q;
  std::uint64_t target;
  std::vector<double> s;
};

inline constexpr int kLeavesBox = 255;
inline constexpr int kUnsettled = 254;

class Search {
 public:
  Search(const Grid& grid, const toy::Toy& model) : grid_(grid), model_(model) {}

  /// Lines 1 to 8 for one seed point.
  void seed(const std::array<int, 3>& at, const std::vector<std::vector<double>>& states) {
    int l = 0;
    for (const auto& s : states) store(at, l++, s, 0);
  }

  /// Lines 9 to 21 for the requests that are in the queue now; answers whether there were any.
  /// The order is design.md's section 2: ascending (source point, source level, direction).
  bool round() {
    // Seeds are looked at once, also where a box of one point leaves nothing to ask for.
    if (queue_.empty() && generation_ > 0) return false;
    std::vector<Request> generation = std::exchange(queue_, {});
    std::sort(generation.begin(), generation.end(), [](const Request& a, const Request& b) {
      return std::tuple(a.source, a.level, a.q) < std::tuple(b.source, b.level, b.q);
    });
    ++generation_;
    for (const Request& r : generation) {
      int l = 0;
      while (x_.contains({r.target, l}) &&
             !toy::equal(model_, x_.at({r.target, l}).s.data(), r.s.data()))
        ++l;
      if (!x_.contains({r.target, l})) store(coordinates(r.target), l, r.s, generation_);
      x_.at({r.source, r.level}).D[static_cast<std::size_t>(r.q)] = l;
    }
    return true;
  }

  const X& x() const { return x_; }
  unsigned generation() const { return generation_; }

 private:
  std::uint64_t index(const std::array<int, 3>& at) const {
    std::uint64_t p = 0;
    for (int a = 2; a >= 0; --a)
      p = p * static_cast<std::uint64_t>(grid_.counts[a]) + static_cast<std::uint64_t>(at[a]);
    return p;
  }
  std::array<int, 3> coordinates(std::uint64_t p) const {
    std::array<int, 3> at;
    for (int a = 0; a < 3; ++a) {
      at[a] = static_cast<int>(p % static_cast<std::uint64_t>(grid_.counts[a]));
      p /= static_cast<std::uint64_t>(grid_.counts[a]);
    }
    return at;
  }

  void store(const std::array<int, 3>& at, int l, const std::vector<double>& s,
             unsigned generation) {
    Record& record = x_[{index(at), l}];
    record.s = s;
    record.generation = generation;
    record.D.fill(kLeavesBox);
    // expand_state
    int q = 0;
    for (int d3 = -1; d3 <= 1; ++d3) {
      for (int d2 = -1; d2 <= 1; ++d2) {
        for (int d1 = -1; d1 <= 1; ++d1) {
          if (d1 == 0 && d2 == 0 && d3 == 0) continue;
          const std::array<int, 3> to{at[0] + d1, at[1] + d2, at[2] + d3};
          bool inside = true;
          for (int a = 0; a < 3; ++a) inside &= to[a] >= 0 && to[a] < grid_.counts[a];
          if (inside) {
            std::array<double, 3> x;
            for (int a = 0; a < 3; ++a) x[a] = grid_.origin[a] + grid_.spacing * at[a];
            const std::array<double, 3> d{grid_.spacing * d1, grid_.spacing * d2,
                                          grid_.spacing * d3};
            Request r{index(at), l, q, index(to), std::vector<double>(s.size())};
            toy::convert(model_, s.data(), x.data(), d.data(), r.s.data());
            queue_.push_back(std::move(r));
            record.D[static_cast<std::size_t>(q)] = kUnsettled;
          }
          ++q;
        }
      }
    }
  }

  Grid grid_;
  toy::Toy model_;
  X x_;
  std::vector<Request> queue_;
  unsigned generation_ = 0;
};

}  // namespace reference
