#include "libcore/search/seed.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "libcore/base/error.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/text.hpp"
#include "libcore/grid/describe.hpp"
#include "libcore/grid/grid.hpp"

namespace hapgrid {

namespace {

// A seed's position is written in decimal: it names the grid point within this share of the
// spacing.
constexpr double kPositionTolerance = 1e-6;

std::string to_text(const Vec3& x) {
  using hapgrid::to_text;
  return format("({}, {}, {})", to_text(x[0]), to_text(x[1]), to_text(x[2]));
}

PointIndex point_at(const Box& box, const Vec3& position) {
  GridCoordinates c{};
  for (int a = 0; a < 3; ++a) {
    const double steps = (position[a] - box.origin[a]) / box.spacing;
    const double nearest = std::round(steps);
    if (!(nearest >= 0 && nearest < box.counts[a]))
      throw Error(format("seed {}: outside the box, which spans {} to {}", to_text(position),
                         to_text(box.origin), to_text(box.high())));
    if (std::abs(steps - nearest) > kPositionTolerance)
      throw Error(format("seed {}: not a grid point", to_text(position)));
    c[a] = static_cast<std::uint32_t>(nearest);
  }
  return box.index(c);
}

std::vector<double> known_states(Model& model, const Box& box, PointIndex point) {
  std::vector<double> states = model.known_states(box.position(point));
  if (!states.empty()) return states;
  throw Error(format(
      "seed {} at {}: the model knows no state there; choose a larger box or other seeds, or "
      "give their states",
      describe(box, point), to_text(box.position(point))));
}

}  // namespace

Seeds seed_states(const Definition& definition, Model& model) {
  const Box& box = definition.box;
  Seeds seeds;
  for (const SeedDefinition& seed : definition.seeds) {
    const PointIndex point = point_at(box, seed.position);
    std::vector<double> states;
    for (const std::vector<double>& state : seed.states) {
      if (state.size() != model.state_size())
        throw Error(format("seed {}: a state of {} components, the model's have {}",
                           to_text(seed.position), state.size(), model.state_size()));
      states.insert(states.end(), state.begin(), state.end());
    }
    if (states.empty()) states = known_states(model, box, point);
    if (!seeds.emplace(point, std::move(states)).second)
      throw Error(format("seed {}: given twice", to_text(seed.position)));
  }
  if (!seeds.empty()) return seeds;
  // The corners; along an axis with one point, two of them are the same.
  for (unsigned corner = 0; corner < 8; ++corner) {
    GridCoordinates c{};
    for (int a = 0; a < 3; ++a) c[a] = corner >> a & 1 ? box.counts[a] - 1 : 0;
    const PointIndex point = box.index(c);
    if (!seeds.contains(point)) seeds[point] = known_states(model, box, point);
  }
  return seeds;
}

GridSpec spec_of(const Definition& definition, const Model& model) {
  const ModelInfo& info = model.info();
  const double reach = std::sqrt(3.0) * definition.box.spacing;
  if (info.d_max < reach)
    throw Error(
        format("grid.spacing {} is too coarse: a step along the diagonal is {}, and the model's "
               "conversion is defined up to d_max = {}; a spacing of at most {} works",
               to_text(definition.box.spacing), to_text(reach), to_text(info.d_max),
               to_text(info.d_max / std::sqrt(3.0))));
  GridSpec spec;
  static_cast<ModelDescription&>(spec) = info;
  spec.box = definition.box;
  spec.model = definition.model;
  spec.parameters = definition.parameters;
  spec.max_levels = definition.max_levels;
  if (!spec.stored.shape) spec.spheres.clear();
  return spec;
}

void write_seeds(const Definition& definition, const GridSpec& spec, Model& model,
                 SectionWriter& out) {
  const Neighbourhood neighbourhood(spec.box);
  const std::uint32_t n = spec.state_size;
  std::vector<double> row(spec.row_size());
  const Seeds seeds = seed_states(definition, model);
  std::uint64_t records = 0;
  for (const auto& [point, states] : seeds) records += states.size() / n;
  require_possible(spec.box, records);
  for (const auto& [point, states] : seeds) {
    const std::string where = "seed " + describe(spec.box, point);
    const std::size_t count = states.size() / n;
    if (count > spec.max_levels)
      throw Error(format("{}: {} states, the level limit is {} (search.max_levels)", where, count,
                         spec.max_levels));
    Level links[kDirections];
    const DirectionMask inside = neighbourhood.inside(point);
    for (int q = 0; q < kDirections; ++q) links[q] = inside >> q & 1 ? kUnsettled : kLeavesBox;
    for (std::size_t l = 0; l < count; ++l) {
      const double* state = &states[l * n];
      for (std::uint32_t c = 0; c < n; ++c)
        if (!std::isfinite(state[c])) throw Error(where + ": a state that is not finite");
      if (!model.equal(state, state))
        throw ModelError(
            format("{}: the model's tolerance function tells state {} from itself", where, l));
      for (std::size_t other = 0; other < l; ++other)
        if (model.equal(&states[other * n], state))
          throw Error(format("{}: states {} and {} are equal within the tolerance {}", where, other,
                             l, to_text(spec.tolerance)));
      std::copy_n(state, n, row.begin());
      if (row.size() > n && !model.complete(spec.box.position(point), row.data()))
        throw ModelError(where + ": " + model.error());
      out.record(point, static_cast<Level>(l), 0, row.data(), links);
    }
  }
  out.finish();
}

}  // namespace hapgrid
