#include "libcore/check/walk.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <limits>
#include <utility>

#include "libcore/base/format.hpp"
#include "libcore/base/parallel.hpp"
#include "libcore/base/random.hpp"
#include "libcore/base/text.hpp"
#include "libcore/grid/vec3.hpp"
#include "libcore/model/state_distance.hpp"

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

namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
// A walk starts at a point around which the state changes. It draws up to so many points to find
// one: if one point in a hundred is such, two of three walks find one.
constexpr int kDraws = 100;

/// The seed of a walk. The seeds of two walks are unrelated.
std::uint64_t seed_of(std::uint64_t seed, std::uint64_t walk) {
  constexpr std::uint64_t kAll = ~std::uint64_t{0};
  return SplitMix64(SplitMix64(seed).below(kAll) + walk).below(kAll);
}

/// Walks with one model; for one thread.
class Walker {
 public:
  Walker(const Grid& grid, std::unique_ptr<Model> model, std::unique_ptr<Traversal> play)
      : grid_(grid),
        cells_(grid),
        model_(std::move(model)),
        fields_(grid.spec(), *model_),
        play_(std::move(play)),
        row_(grid.spec().row_size()),
        next_(row_.size()),
        coarse_(row_.size()) {}

  Walked walk(std::uint64_t seed) {
    Walked seen;
    if (grid_.box().points() == 1) return seen;  // there is no place off it
    RandomHand hand(grid_.box(), seed, kStepsToPlace);
    for (int draw = 0; draw < kDraws && !changes_around(hand.jump()); ++draw) continue;
    // If play cannot start or continue, `complete` and `links` say why.
    if (!play_->start(hand.at()).usable() || !start_model()) return seen;
    for (int place = 0; place < kPlacesInWalk; ++place) {
      hand.set_out();
      bool fails = false;
      for (int i = 0; i < kStepsToPlace && !fails; ++i) {
        const Vec3 from = hand.at();
        hand.step();
        if (!play_->step(hand.at()).usable() || !is_finite(play_->row())) return seen;
        fails = !convert(row_.data(), from, hand.at(), next_, seen.failed);
        if (!fails) std::swap(row_, next_);
      }
      if (!fails && compare_at(hand.at(), seen)) continue;
      if (!meet_at_corner(hand)) return seen;
    }
    return seen;
  }

 private:
  /// Whether the state that play starts with changes on the way to a neighbour.
  bool changes_around(PointIndex point) const {
    if (grid_.levels(point) == 0) return false;
    const RecordIndex r = grid_.first(point);
    for (int q = 0; q < kDirections; ++q) {
      const RecordIndex target = grid_.destination(r, q);
      if (target != Grid::kNoRecord &&
          !model_->equal(grid_.row(r).data(), grid_.row(target).data()))
        return true;
    }
    return false;
  }

  /// The model starts with play's row. Play is at a point of the grid, where its row is a record.
  bool start_model() {
    std::copy(play_->row().begin(), play_->row().end(), row_.begin());
    return is_finite(row_);
  }

  /// Moves the hand to the nearest corner of the cell. Play and the model go on from play's record
  /// there. Without such a record, play starts again.
  bool meet_at_corner(RandomHand& hand) {
    int corner = 0;
    for (int a = 0; a < 3; ++a) {
      const double low = grid_.box().position(play_->cell())[a];
      if (grid_.box().counts[a] > 1 && 2 * (play_->position()[a] - low) > grid_.box().spacing)
        corner |= 1 << a;
    }
    const RecordIndex record = play_->records()[corner];
    hand.put(grid_.box().position(cells_.point(grid_.box().index(play_->cell()), corner)));
    if (record == Grid::kNoRecord) return play_->start(hand.at()).usable() && start_model();
    if (!play_->step(hand.at()).usable()) return false;
    std::copy(grid_.row(record).begin(), grid_.row(record).end(), row_.begin());
    return is_finite(row_);
  }

  bool convert(const double* s, const Vec3& from, const Vec3& to, std::vector<double>& row,
               Findings& failed) {
    ++failed.counted;
    if (model_->convert(s, from, to - from, row.data())) return true;
    failed.offend([&] {
      return format("conversion to ({}, {}, {}) failed: {}", rounded(to[0]), rounded(to[1]),
                    rounded(to[2]), model_->error());
    });
    return false;
  }

  /// Compares play and the model at x. Returns false when both must start again from one record.
  bool compare_at(const Vec3& x, Walked& seen) {
    int corners = 0, same = 0;
    for (int c = 0; c < 8; ++c) {
      if (!cells_.is_corner(c)) continue;
      ++corners;
      const RecordIndex r = play_->records()[c];
      if (r == Grid::kNoRecord) continue;
      if (!is_finite(grid_.row(r))) return false;
      const Vec3 corner = grid_.box().position(grid_.point(r));
      if (!convert(grid_.state(r).data(), corner, x, next_, seen.failed)) return false;
      if (!model_->equal(next_.data(), row_.data())) continue;
      if (!convert(row_.data(), x, corner, next_, seen.failed)) return false;
      same += model_->equal(next_.data(), grid_.state(r).data());
    }
    ++seen.places;
    if (same == 0) {
      ++seen.parted;
      return false;
    }
    PlayError error{off(play_->row()), force_off(x, play_->row()), kNone};
    if (same < corners) {
      ++seen.mixed;
      note(seen.mixed_state, error.state, x);
      return true;
    }
    if (is_empty(error)) {
      ++seen.empty;
      return true;
    }
    if (interpolate_coarsely(x)) error.coarse_state = off(coarse_);
    seen.one_branch.push_back(error);
    note(seen.state, error.state, x);
    note(seen.force, error.force, x);
    return true;
  }

  /// Whether all corners, which are records here, have the state of the model. Play's state is then
  /// the same, and a stored force has no error.
  bool is_empty(const PlayError& error) const {
    for (int c = 0; c < 8; ++c)
      if (!model_->equal(grid_.row(play_->records()[c]).data(), row_.data())) return false;
    return !(grid_.spec().stored.force && error.force > 0);
  }

  double off(std::span<const double> row) { return state_distance(*model_, row_, row); }
  double force_off(const Vec3& x, std::span<const double> row) const {
    if (!fields_.has_force()) return 0;
    const double off = length_of(fields_.force(x, row) - fields_.force(x, row_));
    // A blend may be a state of which the model has no force.
    return std::isnan(off) ? std::numeric_limits<double>::infinity() : off;
  }

  void note(Figure& worst, double value, const Vec3& x) const {
    if (!(value > worst.value)) return;
    const GridCoordinates& c = play_->cell();
    worst.value = value;
    worst.where = format("at ({}, {}, {}), in cell ({}, {}, {})", rounded(x[0]), rounded(x[1]),
                         rounded(x[2]), c[0], c[1], c[2]);
  }

  /// Interpolates coarse_ in a cell of twice the size that contains play's cell. Each of its
  /// corners is at most one link away from a corner of play's cell. Returns false when such a link
  /// is one-way, because it leaves the branch, and when an axis has only two points.
  bool interpolate_coarsely(const Vec3& x) {
    const Box& box = grid_.box();
    const GridCoordinates& cell = play_->cell();
    GridCoordinates low = cell;
    Vec3 xbar{0, 0, 0};
    for (int a = 0; a < 3; ++a) {
      if (box.counts[a] == 1) continue;
      if (box.counts[a] == 2) return false;
      low[a] = std::min(cell[a] & ~1u, box.counts[a] - 3);
      xbar[a] = (x[a] - box.position(low)[a]) / (2 * box.spacing);
      xbar[a] = std::clamp(xbar[a], 0.0, 1.0);
    }
    const std::array<double, 8> weights = corner_weights(xbar);
    std::fill(coarse_.begin(), coarse_.end(), 0.0);
    for (int corner = 0; corner < 8; ++corner) {
      if (!cells_.is_corner(corner)) continue;  // its weight is 0
      std::array<int, 3> step{};
      for (int a = 0; a < 3; ++a) {
        const int bit = corner >> a & 1;
        if (box.counts[a] > 1)
          step[a] = static_cast<int>(low[a]) + 2 * bit - (static_cast<int>(cell[a]) + bit);
      }
      RecordIndex record = play_->records()[corner];
      if (step != std::array<int, 3>{0, 0, 0}) {
        const Direction towards = Direction::of(step[0], step[1], step[2]);
        const RecordIndex near = record;
        record = grid_.destination(near, towards.q());
        if (record == Grid::kNoRecord ||
            grid_.destination(record, towards.opposite().q()) != near ||
            !is_finite(grid_.row(record)))
          return false;
      }
      for (std::size_t i = 0; i < coarse_.size(); ++i)
        coarse_[i] += weights[corner] * grid_.row(record)[i];
    }
    return true;
  }

  const Grid& grid_;
  const Cells cells_;
  const std::unique_ptr<Model> model_;
  const Fields fields_;
  const std::unique_ptr<Traversal> play_;
  std::vector<double> row_;  // the model's that walked: its state, and what is stored with it
  std::vector<double> next_;
  std::vector<double> coarse_;
};

}  // namespace

void Walked::add(Walked&& later) {
  places += later.places;
  empty += later.empty;
  mixed += later.mixed;
  parted += later.parted;
  one_branch.insert(one_branch.end(), later.one_branch.begin(), later.one_branch.end());
  for (Figure Walked::*worst : {&Walked::state, &Walked::force, &Walked::mixed_state})
    if ((later.*worst).value > (this->*worst).value) this->*worst = std::move(later.*worst);
  failed.add(std::move(later.failed));
}

Walked walk_grid(const Grid& grid, std::uint64_t walks, std::uint64_t seed,
                 const MakeModel& make_model,
                 const std::function<std::unique_ptr<Traversal>()>& make_traversal, int threads,
                 std::atomic<std::uint64_t>& walks_done) {
  std::deque<Walker> walkers;
  for (int t = 0; t < threads; ++t) walkers.emplace_back(grid, make_model(), make_traversal());
  std::vector<Walked> found(walks);
  for_each_with_own(found.size(), walkers, [&](Walker& walker, std::size_t w) {
    found[w] = walker.walk(seed_of(seed, w));
    ++walks_done;
  });
  return sum_of(std::move(found));
}

}  // namespace hapgrid
