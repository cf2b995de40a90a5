#include "libcore/check/energy.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <optional>
#include <set>
#include <utility>

#include "libcore/base/parallel.hpp"

namespace hapgrid {

namespace {

constexpr std::uint64_t kRecordBlock = 1 << 12;
// How often a record's potential is lowered before the search is given up: on real grids once or
// twice, and by Bellman and Ford's bound as often as there are records.
constexpr std::uint64_t kMostLowered = 256;
// How often a steeper closed walk is looked for: each is steeper than the one before, and on real
// grids some ten are enough.
constexpr int kMostRates = 30;

/// Bellman-Ford on the links, from a potential that fits nearly everywhere.
class Relaxation {
 public:
  Relaxation(const Grid& grid, const Work& work, int threads)
      : grid_(grid),
        work_(work),
        threads_(threads),
        potential_(grid.records()),
        part_(grid.records()) {}

  /// A potential: the energy where there is one, else exact along a tree of links: reversible ones
  /// first, so that a part of the grid that they connect has one zero, and those with the smallest
  /// allowances first of all, so that a place where the spacing does not resolve the force is at
  /// the tree's ends.
  void integrate() {
    std::vector<bool> is_set(grid_.records());
    std::array<std::deque<Link>, kQueues> reversible;
    std::deque<Link> one_way;
    std::size_t queue = 0;  // none before this one has links
    const auto set = [&](RecordIndex r, double value, std::uint32_t part) {
      is_set[r] = true;
      potential_[r] = work_.energy(r).value_or(value);
      part_[r] = part;
      for (int q = 0; q < kDirections; ++q) {
        const RecordIndex target = grid_.destination(r, q);
        if (!work_.takes(q) || target == Grid::kNoRecord || is_set[target]) continue;
        if (!work_.is_reversible({r, q})) {
          one_way.push_back({r, q});
          continue;
        }
        const std::size_t into = queue_of(work_.allowance({r, q}));
        reversible[into].push_back({r, q});
        queue = std::min(queue, into);
      }
    };
    std::uint32_t parts = 0;
    const auto follow = [&](std::deque<Link>& links, bool stays_in_part) {
      const Link link = links.front();
      links.pop_front();
      const RecordIndex target = grid_.destination(link.from, link.q);
      if (is_set[target]) return;
      set(target, potential_[link.from] - work_.gain(link),
          stays_in_part ? part_[link.from] : parts++);
    };
    for (RecordIndex root = 0; root < grid_.records(); ++root) {
      if (is_set[root]) continue;
      set(root, 0, parts++);
      for (;;) {
        while (queue < kQueues && reversible[queue].empty()) ++queue;
        if (queue < kQueues)
          follow(reversible[queue], true);
        else if (!one_way.empty())
          follow(one_way, false);
        else
          break;
      }
    }
  }

  const std::vector<double>& potential() const { return potential_; }
  const std::vector<std::uint32_t>& part() const { return part_; }

  /// Lowers the potential until each link fits, or a cycle shows that none can: one with a larger
  /// rate.
  std::optional<ClosedWalk> relax(double rate) {
    rate_ = rate;
    gave_up_ = false;
    parent_.assign(grid_.records(), {Grid::kNoRecord, 0});
    is_waiting_.assign(grid_.records(), false);
    waiting_.clear();
    for (const RecordIndex r : unfit()) wait_for(r);
    std::uint64_t lowered = 0, next_look = kRecordBlock;
    std::vector<RecordIndex> touched;
    while (!waiting_.empty()) {
      const RecordIndex r = waiting_.front();
      waiting_.pop_front();
      is_waiting_[r] = false;
      for (int q = 0; q < kDirections; ++q) {
        const std::optional<double> lower = fit({r, q});
        if (!lower) continue;
        const RecordIndex target = grid_.destination(r, q);
        potential_[target] = *lower;
        if (parent_[target].from == Grid::kNoRecord) touched.push_back(target);
        parent_[target] = {r, q};
        wait_for(target);
        ++lowered;
      }
      if (lowered < next_look && !waiting_.empty()) continue;
      if (lowered > kMostLowered * grid_.records()) {
        gave_up_ = true;
        return std::nullopt;
      }
      // A cycle of parents is a negative one. Looking costs no more than what was done since.
      if (auto cycle = find_cycle(touched)) return cycle;
      next_look = lowered + std::max<std::uint64_t>(kRecordBlock, touched.size());
    }
    return std::nullopt;
  }

  /// Whether the last relax() ended undecided.
  bool gave_up() const { return gave_up_; }

  /// Leaves a link out from now on.
  void ban(const Link& link) { banned_.insert(slot(link)); }

 private:
  static constexpr std::size_t kQueues = 66;
  /// Allowances of up to a factor of two, the smallest first; where there is no force, in the
  /// first.
  static std::size_t queue_of(double allowance) {
    if (allowance == 0) return 0;
    if (!std::isfinite(allowance)) return kQueues - 1;
    return static_cast<std::size_t>(std::clamp(std::ilogb(allowance) + 40, 1, int{kQueues} - 1));
  }

  static std::uint64_t slot(const Link& link) {
    return std::uint64_t{link.from} * kDirections + static_cast<std::uint64_t>(link.q);
  }

  void wait_for(RecordIndex r) {
    if (is_waiting_[r]) return;
    is_waiting_[r] = true;
    waiting_.push_back(r);
  }

  /// What the potential at the link's end must be lowered to; nothing where it fits.
  std::optional<double> fit(const Link& link) const {
    const RecordIndex target = grid_.destination(link.from, link.q);
    if (!work_.takes(link.q) || target == Grid::kNoRecord) return std::nullopt;
    // Most links fit without an allowance, which takes longer.
    const double tight = potential_[link.from] - work_.gain(link);
    if (!(potential_[target] > tight)) return std::nullopt;
    const double lower = tight + work_.allowance(link) + rate_ * work_.length(link);
    // Not for less than what rounding makes of the sum.
    const double least = 1e-12 * (std::abs(tight) + std::abs(potential_[target]));
    if (!(potential_[target] > lower + least)) return std::nullopt;
    if (!banned_.empty() && banned_.contains(slot(link))) return std::nullopt;
    return lower;
  }

  /// The records from which a link does not fit, ascending.
  std::vector<RecordIndex> unfit() const {
    struct Records {
      std::vector<RecordIndex> all;
      void add(Records&& later) { all.insert(all.end(), later.all.begin(), later.all.end()); }
    };
    return sum_of_blocks<Records>(grid_.records(), kRecordBlock, threads_,
                                  [&](std::uint64_t begin, std::uint64_t end) {
                                    Records records;
                                    for (auto r = static_cast<RecordIndex>(begin); r < end; ++r)
                                      for (int q = 0; q < kDirections; ++q)
                                        if (fit({r, q})) {
                                          records.all.push_back(r);
                                          break;
                                        }
                                    return records;
                                  })
        .all;
  }

  std::optional<ClosedWalk> find_cycle(const std::vector<RecordIndex>& touched) const {
    std::vector<std::uint32_t> walk_of(grid_.records(), 0);  // 0: not seen
    std::uint32_t walk = 0;
    for (const RecordIndex start : touched) {
      ++walk;
      RecordIndex r = start;
      while (r != Grid::kNoRecord && walk_of[r] == 0) {
        walk_of[r] = walk;
        r = parent_[r].from;
      }
      if (r == Grid::kNoRecord || walk_of[r] != walk) continue;
      ClosedWalk cycle;
      RecordIndex at = r;
      do {
        cycle.links.push_back(parent_[at]);
        cycle.gain += work_.gain(parent_[at]);
        cycle.allowance += work_.allowance(parent_[at]);
        cycle.length += work_.length(parent_[at]);
        at = parent_[at].from;
      } while (at != r);
      std::reverse(cycle.links.begin(), cycle.links.end());
      // From where the grid has it first, whoever found it.
      std::rotate(cycle.links.begin(),
                  std::min_element(cycle.links.begin(), cycle.links.end(),
                                   [](const Link& a, const Link& b) { return a.from < b.from; }),
                  cycle.links.end());
      return cycle;
    }
    return std::nullopt;
  }

  const Grid& grid_;
  const Work& work_;
  const int threads_;
  double rate_ = 0;
  std::vector<double> potential_;
  std::vector<std::uint32_t> part_;
  std::vector<Link> parent_;
  std::vector<bool> is_waiting_;
  std::deque<RecordIndex> waiting_;
  std::set<std::uint64_t> banned_;
  bool gave_up_ = false;
};

}  // namespace

Energy find_energy(const Grid& grid, const Work& work, int threads, std::size_t most,
                   double tolerated) {
  Energy energy;
  Relaxation relaxation(grid, work, threads);
  relaxation.integrate();
  energy.potential = relaxation.potential();
  energy.part = relaxation.part();
  for (int i = 0; i < kMostRates && !energy.is_steepest; ++i) {
    auto steeper = relaxation.relax(energy.steepest.rate());
    // A cycle that is no steeper is one of rounding.
    if (steeper && steeper->rate() > energy.steepest.rate())
      energy.steepest = std::move(*steeper);
    else
      energy.is_steepest = !relaxation.gave_up();
    if (relaxation.gave_up()) break;
  }
  relaxation.integrate();
  while (auto cycle = relaxation.relax(tolerated)) {
    const auto excess = [&](const Link& link) {
      return work.gain(link) - work.allowance(link) - tolerated * work.length(link);
    };
    relaxation.ban(
        *std::max_element(cycle->links.begin(), cycle->links.end(),
                          [&](const Link& a, const Link& b) { return excess(a) < excess(b); }));
    energy.gaining.push_back(std::move(*cycle));
    if (energy.gaining.size() == most) break;
  }
  energy.gave_up = relaxation.gave_up();
  return energy;
}

}  // namespace hapgrid
