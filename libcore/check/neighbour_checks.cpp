#include "libcore/check/neighbour_checks.hpp"

#include <algorithm>
#include <string>

#include "libcore/grid/describe.hpp"

namespace hapgrid {

NeighbourChecks::NeighbourChecks(const GridSpec& spec, std::uint32_t generation, bool has_tears)
    : spec_(spec),
      generation_(generation),
      has_tears_(has_tears),
      around_(spec.box),
      inside_of_(spec.box, around_),
      window_(spec),
      coverage_{"coverage", "points", "points without a level", {}},
      links_{"links", "directions", "destination levels that cannot be", {}},
      fractions_{"fractions",
                 "directions",
                 "one-way links without a tear fraction, and other directions that have one",
                 {}},
      distances_(spec.box) {}

void NeighbourChecks::add(const RecordLinks& record) {
  window_.add(record.point, record.level, record.generation, record.links,
              [this](PointIndex p) { look(p); });
  // Where each distance is what the generation says; else these rows are not asked for.
  distances_.add(record.point, record.level, record.generation, record.generation);
  const auto is_torn = [](TearByte tear) { return tear != kNoTear; };
  if (!record.tears || std::none_of(record.tears, record.tears + kDirections, is_torn)) return;
  torn_.push_back({record.point, record.level, {}});
  std::copy_n(record.tears, kDirections, torn_.back().tears.begin());
}

void NeighbourChecks::finish() {
  window_.finish([this](PointIndex p) { look(p); });
}

void NeighbourChecks::look(PointIndex p) {
  const RecordIndex levels = window_.levels(p);
  ++coverage_.found.counted;
  if (levels == 0) coverage_.found.offend({p, {}, {}}, [&] { return describe(spec_.box, p); });
  links_.found.counted += levels * kDirections;
  fractions_.found.counted += levels * kDirections;
  const DirectionMask inside = inside_of_(p);
  // The ordinary case: nothing leaves the box, and all there is around has level 0 alone.
  const bool is_plain = levels == 1 && inside == kAllDirections && window_.is_plain(p);
  const bool has_torn = !torn_.empty() && torn_.front().point == p;
  for (RecordIndex l = 0; l < levels; ++l) {
    const auto level = static_cast<Level>(l);
    if (!is_plain || window_.record(p, level).generation == generation_)
      check_links(p, level, inside);
    if (has_tears_ && (!is_plain || has_torn)) check_fractions(p, level);
    if (proves_distances_)
      proves_distances_ = is_plain ? is_at_distance(p) : is_at_distance(p, level, inside);
  }
}

namespace {
/// What is wrong with a destination level, empty when nothing is.
/// @param levels of the point where the direction leads, in the box
std::string link_fault(Level level, bool is_inside, bool in_frontier, const Box& box,
                       PointIndex target, RecordIndex levels) {
  const std::string shown = "destination level " + std::to_string(level);
  if (!is_inside) return level == kLeavesBox ? "" : shown + ", but the direction leaves the box";
  if (level == kLeavesBox) return "marked as leaving the box, but it stays inside";
  if (in_frontier) return level == kUnsettled ? "" : shown + ", but the record is in the frontier";
  if (level == kUnsettled) return "not settled, but the record is not in the frontier";
  if (level < levels) return "";
  return shown + ", but " + describe(box, target) + " has " + std::to_string(levels) + " levels";
}
}  // namespace

void NeighbourChecks::check_links(PointIndex p, Level level, DirectionMask inside) {
  const Links& links = window_.links(p, level);
  const bool in_frontier = window_.record(p, level).generation == generation_;
  for (int q = 0; q < kDirections; ++q) {
    const bool is_inside = inside >> q & 1;
    const auto target = static_cast<PointIndex>(p + around_.offset(q));
    const RecordIndex there = is_inside ? window_.levels(target) : 0;
    // The ordinary cases without strings.
    if (is_inside ? !in_frontier && (links.usable >> q & 1) && links.level[q] < there
                  : links.level[q] == kLeavesBox)
      continue;
    const std::string fault =
        link_fault(links.level[q], is_inside, in_frontier, spec_.box, target, there);
    if (!fault.empty())
      links_.found.offend({p, level, q},
                          [&] { return describe_link(spec_.box, p, level, q) + ": " + fault; });
  }
}

/// As Grid::is_one_way().
bool NeighbourChecks::is_one_way(PointIndex p, Level level, int q) const {
  const Links& links = window_.links(p, level);
  if (!(links.usable >> q & 1)) return false;
  const auto target = static_cast<PointIndex>(p + around_.offset(q));
  return links.level[q] < window_.levels(target) &&
         window_.links(target, links.level[q]).level[Direction(q).opposite().q()] != level;
}

void NeighbourChecks::check_fractions(PointIndex p, Level level) {
  std::array<TearByte, kDirections> tears;
  tears.fill(kNoTear);
  if (!torn_.empty() && torn_.front().point == p && torn_.front().level == level) {
    tears = torn_.front().tears;
    torn_.pop_front();
  }
  for (int q = 0; q < kDirections; ++q) {
    const TearByte tear = tears[q];
    if (is_one_way(p, level, q) == (tear != kNoTear)) continue;
    fractions_.found.offend({p, level, q}, [&] {
      return describe_link(spec_.box, p, level, q) +
             (tear == kNoTear ? ": one-way, without a tear fraction"
                              : ": not one-way, with tear fraction " + std::to_string(tear));
    });
  }
}

/// Whether the links around a record are such as proves_distances() says.
bool NeighbourChecks::is_at_distance(PointIndex p, Level level, DirectionMask inside) const {
  const Links& links = window_.links(p, level);
  const std::uint64_t generation = window_.record(p, level).generation;
  bool has_source = generation == 0;
  for (int q = 0; q < kDirections; ++q) {
    if (!(inside >> q & 1)) continue;
    const auto there = static_cast<PointIndex>(p + around_.offset(q));
    const RecordIndex levels = window_.levels(there);
    if ((links.usable >> q & 1) && links.level[q] < levels &&
        window_.record(there, links.level[q]).generation > generation + 1)
      return false;
    const int back = Direction(q).opposite().q();
    for (RecordIndex l = 0; l < levels && !has_source; ++l) {
      const auto source = static_cast<Level>(l);
      has_source = window_.record(there, source).generation + 1 == generation &&
                   (window_.links(there, source).usable >> back & 1) &&
                   window_.links(there, source).level[back] == level;
    }
  }
  return has_source;
}

/// The same of the only record of a plain point (RecordWindow::is_plain).
bool NeighbourChecks::is_at_distance(PointIndex p) const {
  const std::uint64_t generation = window_.record(p, 0).generation;
  bool has_source = generation == 0;
  for (int q = 0; q < kDirections; ++q) {
    const std::uint64_t there =
        window_.record(static_cast<PointIndex>(p + around_.offset(q)), 0).generation;
    if (there > generation + 1) return false;
    has_source |= there + 1 == generation;
  }
  return has_source;
}

}  // namespace hapgrid
