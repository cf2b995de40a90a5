#include "libcore/model/room.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "libcore/base/error.hpp"
#include "libcore/base/text.hpp"

namespace hapgrid {

namespace {

Vec3 corner_of(const Extent3& extent, unsigned corner) {
  Vec3 x{};
  for (int a = 0; a < 3; ++a) x[a] = corner >> a & 1 ? extent.high[a] : extent.low[a];
  return x;
}

bool knows_all_corners(Model& model, const Extent3& extent) {
  try {
    for (unsigned corner = 0; corner < 8; ++corner)
      if (model.known_states(corner_of(extent, corner)).empty()) return false;
  } catch (const ModelError&) {  // it may know nothing so far away
    return false;
  }
  return true;
}

}  // namespace

std::optional<Extent3> extent_with_probe(Model& model, const Vec3& x, const double* state) {
  const ModelInfo& info = model.info();
  if (info.spheres.empty()) return std::nullopt;
  std::vector<double> row(state, state + info.state_size);
  row.resize(info.row_size());
  std::vector<float> centres(3 * info.spheres.size());
  if (info.stored.shape) {
    if (!model.complete(x, row.data())) return std::nullopt;
    std::copy(row.end() - static_cast<std::ptrdiff_t>(centres.size()), row.end(), centres.begin());
  } else {
    model.shape(state, centres);
  }
  Extent3 extent{{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
  for (std::size_t i = 0; i < centres.size(); ++i) {
    const double reach = info.spheres[i / 3].radius + info.hip_radius;
    extent.low[i % 3] = std::min(extent.low[i % 3], centres[i] - reach);
    extent.high[i % 3] = std::max(extent.high[i % 3], centres[i] + reach);
  }
  return extent;
}

std::string larger_box(Model& model, const Box& box) {
  constexpr double kFactor = 1.1;
  constexpr int kTries = 30;  // up to 17 times as large
  const auto& n = box.counts;
  Extent3 extent{box.position(GridCoordinates{0, 0, 0}),
                 box.position(GridCoordinates{n[0] - 1, n[1] - 1, n[2] - 1})};
  for (int k = 0; k < kTries; ++k) {
    for (int a = 0; a < 3; ++a) {
      const double grow = (kFactor - 1) / 2 * (extent.high[a] - extent.low[a]);
      extent.low[a] -= grow;
      extent.high[a] += grow;
    }
    if (!knows_all_corners(model, extent)) continue;
    std::string text = "the box is too small: in one " + extent_text(extent) +
                       " it would know states in all corners";
    const std::vector<double> states = model.known_states(extent.low);
    if (const auto shape = extent_with_probe(model, extent.low, states.data()))
      text += ", and its shape with the probe around it reaches " + extent_text(*shape);
    return text;
  }
  return "";
}

std::string extent_text(const Extent3& extent) {
  const auto point = [](const Vec3& x) {
    return "(" + fixed(x[0], 2) + ", " + fixed(x[1], 2) + ", " + fixed(x[2], 2) + ")";
  };
  return "from " + point(extent.low) + " to " + point(extent.high);
}

}  // namespace hapgrid
