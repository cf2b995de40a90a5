// Grids of the hung ball in memory: Algorithm 1 with a queue, as the paper prints it.
#pragma once

#include <deque>
#include <map>
#include <utility>
#include <vector>

#include "libcore/grid/grid.hpp"
#include "tests/unit/hung_ball/reference.hpp"

namespace hung_ball {

inline hapgrid::Grid grid(const hapgrid::Box& box,
                          const std::vector<hapgrid::Parameter>& parameters) {
  using namespace hapgrid;
  const auto model = make(parameters);
  const Neighbourhood around(box);
  struct Record {
    double state;
    std::array<Level, kDirections> links;
  };
  std::map<PointIndex, std::vector<Record>> points;
  std::deque<std::pair<PointIndex, Level>> queue;
  const auto level_of = [&](PointIndex p, double state) {
    std::vector<Record>& records = points[p];
    for (std::size_t l = 0; l < records.size(); ++l)
      if (model->equal(&records[l].state, &state)) return static_cast<Level>(l);
    records.push_back({state, {}});
    records.back().links.fill(kLeavesBox);
    queue.push_back({p, static_cast<Level>(records.size() - 1)});
    return queue.back().second;
  };
  for (int corner = 0; corner < 8; ++corner) {
    GridCoordinates c;
    for (int a = 0; a < 3; ++a) c[a] = corner >> a & 1 ? box.counts[a] - 1 : 0;
    level_of(box.index(c), 0);
  }
  while (!queue.empty()) {
    const auto [p, level] = queue.front();
    queue.pop_front();
    for (int q = 0; q < kDirections; ++q) {
      if (!(around.inside(p) >> q & 1)) continue;
      const double reached =
          convert(*model, points[p][level].state, box.position(p), around.shift(q));
      const Level to = level_of(static_cast<PointIndex>(p + around.offset(q)), reached);
      points[p][level].links[static_cast<std::size_t>(q)] = to;
    }
  }
  GridSpec spec;
  spec.box = box;
  spec.model = "hung-ball";
  spec.parameters = parameters;
  spec.tolerance = 1e-6;
  spec.length_unit = "rope lengths";
  RecordColumns columns;
  for (const auto& [p, records] : points)
    for (std::size_t l = 0; l < records.size(); ++l) {
      columns.point.push_back(p);
      columns.level.push_back(static_cast<Level>(l));
      columns.generation.push_back(0);
      columns.rows.push_back(records[l].state);
      columns.links.insert(columns.links.end(), records[l].links.begin(), records[l].links.end());
    }
  return Grid(spec, 1, columns);
}

}  // namespace hung_ball
