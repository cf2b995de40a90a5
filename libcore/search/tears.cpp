#include "libcore/search/tears.hpp"

#include <algorithm>
#include <bit>
#include <deque>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>

#include "libcore/base/error.hpp"
#include "libcore/grid/describe.hpp"
#include "libcore/grid/state_distance.hpp"
#include "libcore/shard/load.hpp"
#include "libcore/shard/reader.hpp"

namespace hapgrid {

namespace {

/// The search for one tear fraction, a conversion at a time.
class Bisection {
 public:
  explicit Bisection(const Grid& grid)
      : grid_(grid), middle_row_(grid.spec().row_size()), back_row_(grid.spec().row_size()) {}

  void start(std::size_t index, OneWayLink link) {
    index_ = index;
    x_ = grid_.box().position(grid_.point(link.record));
    d_ = grid_.neighbourhood().shift(link.q);
    low_ = 0;
    high_ = kTearSteps;
    is_back_ = false;
    const auto row = [&](RecordIndex r) {
      return std::vector(grid_.row(r).begin(), grid_.row(r).end());
    };
    low_row_ = row(link.record);
    high_row_ = row(grid_.destination(link.record, link.q));
  }

  /// Which of the links it is.
  std::size_t index() const { return index_; }
  /// The conversion to be made, into a row of this object.
  Conversion conversion(std::uint64_t tag) {
    if (is_back_)
      return {middle_row_.data(), at(middle()), shift(low_ - middle()), back_row_.data(), tag};
    return {low_row_.data(), at(low_), shift(middle() - low_), middle_row_.data(), tag};
  }

  /// Takes what it reached. Answers whether the fraction is found.
  bool advance(StateDistance& distance) {
    if (is_back_) {
      halve(distance.is_same(back_row_, low_row_));
    } else {
      is_back_ = true;
      if (high_ - low_ == kTearSteps) return false;
      const double from_low = distance(middle_row_, low_row_);
      const double from_high = distance(middle_row_, high_row_);
      const bool is_low = from_low < from_high;
      if (!(kNearer * std::min(from_low, from_high) <= std::max(from_low, from_high)) ||
          from_low == from_high)
        return false;
      halve(is_low);
    }
    is_back_ = false;
    return high_ - low_ == 1;
  }
  TearByte tear() const { return static_cast<TearByte>(low_); }

 private:
  static constexpr double kNearer = 4;

  int middle() const { return (low_ + high_) / 2; }
  Vec3 shift(int steps) const {
    const double part = static_cast<double>(steps) / kTearSteps;
    return {part * d_[0], part * d_[1], part * d_[2]};
  }
  Vec3 at(int step) const {
    const Vec3 d = shift(step);
    return {x_[0] + d[0], x_[1] + d[1], x_[2] + d[2]};
  }
  void halve(bool is_on_branch) {
    (is_on_branch ? low_ : high_) = middle();
    std::swap(middle_row_, is_on_branch ? low_row_ : high_row_);
  }

  const Grid& grid_;
  std::size_t index_ = 0;
  Vec3 x_{};
  Vec3 d_{};
  int low_ = 0;  // the model snaps between these steps, and these are its states there
  int high_ = kTearSteps;
  std::vector<double> low_row_;
  std::vector<double> high_row_;
  std::vector<double> middle_row_;
  std::vector<double> back_row_;
  bool is_back_ = false;  // goes back from the middle to low_
};

/// Deals out links in ascending order, and remembers the first that failed: no link behind it is
/// given out any more, and all before it are.
class LinkDealer {
 public:
  LinkDealer(std::size_t links, std::size_t models, const Progress& progress)
      : links_(links), threads_(std::min(models, links)), progress_(progress) {}

  std::size_t threads() const { return threads_; }
  bool next(bool idle, std::size_t& index) {
    const std::lock_guard lock(mutex_);
    // The last ones are for models that have nothing to do, not for a second place in a queue.
    if (progress_.stopped() || next_ >= std::min(links_, failed_) ||
        (!idle && links_ - next_ < threads_))
      return false;
    index = next_++;
    return true;
  }
  void fail(std::size_t index, std::string_view why) {
    const std::lock_guard lock(mutex_);
    if (index >= failed_) return;
    failed_ = index;
    why_ = why;
  }
  /// Gives out nothing more.
  void stop() {
    const std::lock_guard lock(mutex_);
    next_ = links_;
  }
  /// @throw Stopped; ModelError for the first link that failed
  void require_success(const Grid& grid, std::span<const OneWayLink> links) const {
    if (progress_.stopped()) throw Stopped();
    if (failed_ >= links_) return;
    throw ModelError("tear fraction of " +
                     describe_link(grid, links[failed_].record, links[failed_].q) + ": " + why_);
  }

 private:
  std::size_t links_;
  std::size_t threads_;
  const Progress& progress_;
  std::mutex mutex_;
  std::size_t next_ = 0;
  std::size_t failed_ = ~std::size_t{0};
  std::string why_;
};

/// What one thread does: as many bisections side by side as its model takes questions at a time.
void bisect(const Grid& grid, std::span<const OneWayLink> links, LinkDealer& dealer, Model& model,
            Progress& progress, std::vector<TearByte>& tears) {
  StateDistance distance(grid.spec(),
                         [&](const double* a, const double* b) { return model.equal(a, b); });
  std::deque<Bisection> bisections;  // a conversion's tag is the number of one
  std::vector<std::size_t> ready;    // those that have a conversion to be made
  std::vector<std::size_t> free;
  CurrentConversion& current = current_conversion();
  model.convert_all(
      [&](Conversion& conversion, bool idle) {
        if (ready.empty()) {
          std::size_t index = 0;
          if (!dealer.next(idle, index)) return false;
          if (free.empty()) {
            free.push_back(bisections.size());
            bisections.emplace_back(grid);
          }
          ready.push_back(free.back());
          free.pop_back();
          bisections[ready.back()].start(index, links[index]);
        }
        const std::size_t number = ready.back();
        ready.pop_back();
        conversion = bisections[number].conversion(number);
        const OneWayLink link = links[bisections[number].index()];
        if (!model.is_process())
          current = {grid.point(link.record), grid.level(link.record), link.q};
        return true;
      },
      [&](const Conversion& conversion, std::string_view error) {
        Bisection& bisection = bisections[conversion.tag];
        progress.tear_conversions.fetch_add(1, std::memory_order_relaxed);
        if (error.empty() && !bisection.advance(distance)) return ready.push_back(conversion.tag);
        free.push_back(conversion.tag);
        if (!error.empty()) return dealer.fail(bisection.index(), error);
        tears[bisection.index()] = bisection.tear();
        progress.links_done.fetch_add(1, std::memory_order_relaxed);
      });
  current.q = -1;
}

/// The tear bytes of the grid's records, R x 26, all kNoTear.
std::vector<TearByte> no_tears(const Grid& grid) {
  return std::vector<TearByte>(std::size_t{grid.records()} * kDirections, kNoTear);
}

std::size_t place(RecordIndex r, int q) {
  return std::size_t{r} * kDirections + static_cast<unsigned>(q);
}

void write_grid(const Grid& grid, const std::vector<TearByte>& tears, SectionWriter& out) {
  for (RecordIndex r = 0; r < grid.records(); ++r)
    out.record(grid.point(r), grid.level(r), grid.record_generation(r), grid.row(r).data(),
               grid.links(r).data(), &tears[place(r, 0)]);
  out.finish();
}

/// Puts the tear fractions of a chunk among those of the grid.
void take(const Grid& grid, const TearRows& rows, std::vector<TearByte>& tears) {
  const auto fail = [&](std::size_t r, int q, const char* what) {
    throw FormatError("tear fractions: " + describe(grid.box(), rows.point[r], rows.level[r]) +
                      ", direction " + std::to_string(q) + ": " + what);
  };
  const TearByte* tear = rows.tears.data();
  for (std::size_t r = 0; r < rows.size(); ++r)
    for (DirectionMask left = rows.directions[r]; left; left &= left - 1, ++tear) {
      const int q = std::countr_zero(left);
      const RecordIndex record = grid.first(rows.point[r]) + rows.level[r];
      if (rows.level[r] >= grid.levels(rows.point[r]) || !grid.is_one_way(record, q))
        fail(r, q, "the grid has no such one-way link");
      TearByte& known = tears[place(record, q)];
      if (known != kNoTear && known != *tear) fail(r, q, "two different answers");
      known = *tear;
    }
}

}  // namespace

std::vector<OneWayLink> one_way_links(const Grid& grid, Part part) {
  std::vector<OneWayLink> links;
  for (RecordIndex r = 0; r < grid.records(); ++r)
    for (int q = 0; q < kDirections; ++q)
      if (grid.is_one_way(r, q)) links.push_back({r, static_cast<std::uint8_t>(q)});
  if (part.of == 1) return links;
  const Deal deal(links.size(), part);
  std::vector<OneWayLink> own;
  for (std::size_t i = 0; i < links.size(); ++i)
    if (deal.has_any(i, i + 1)) own.push_back(links[i]);
  return own;
}

std::vector<TearByte> find_tears(const Grid& grid, std::span<const OneWayLink> links,
                                 Converter& converter, Progress& progress) {
  progress.links = links.size();
  std::vector<TearByte> tears(links.size());
  LinkDealer dealer(links.size(), converter.models(), progress);
  converter.work(
      dealer.threads(), [&](Model& model) { bisect(grid, links, dealer, model, progress, tears); },
      [&] { dealer.stop(); });
  dealer.require_success(grid, links);
  return tears;
}

void write_tears(const Grid& grid, std::span<const OneWayLink> links,
                 std::span<const TearByte> tears, SectionWriter& out) {
  for (std::size_t begin = 0, end = 0; begin < links.size(); begin = end) {
    const RecordIndex r = links[begin].record;
    DirectionMask directions = 0;
    for (; end < links.size() && links[end].record == r; ++end)
      directions |= DirectionMask{1} << links[end].q;
    out.tears(grid.point(r), grid.level(r), directions, &tears[begin]);
  }
  out.finish();
}

void write_torn_grid(const Grid& grid, std::span<const OneWayLink> links,
                     std::span<const TearByte> tears, SectionWriter& out) {
  std::vector<TearByte> all = no_tears(grid);
  for (std::size_t i = 0; i < links.size(); ++i) all[place(links[i].record, links[i].q)] = tears[i];
  write_grid(grid, all, out);
}

void merge_tears(const Section& section, std::span<const Section> shards, SectionWriter& out,
                 Progress& progress) {
  const Grid grid = load_grid(section).grid;
  std::vector<TearByte> tears = no_tears(grid);
  TearRows rows;
  for (const Section& shard : shards) {
    SectionReader reader(shard);
    for (std::size_t i = 0; i < shard.footer.chunks.size(); ++i) {
      reader.read(i, rows);
      take(grid, rows, tears);
      progress.conversions += rows.tears.size();
    }
  }
  const std::vector<OneWayLink> links = one_way_links(grid);
  const auto is_missing = [&](OneWayLink link) {
    return tears[place(link.record, link.q)] == kNoTear;
  };
  if (const auto missing = std::count_if(links.begin(), links.end(), is_missing); missing > 0) {
    const OneWayLink first = *std::find_if(links.begin(), links.end(), is_missing);
    throw FormatError("tear fractions are missing: " + std::to_string(missing) + " of the " +
                      std::to_string(links.size()) + " one-way links, the first of " +
                      describe_link(grid, first.record, first.q) +
                      "; was a shard lost, or is one still to be expanded?");
  }
  write_grid(grid, tears, out);
}

}  // namespace hapgrid
