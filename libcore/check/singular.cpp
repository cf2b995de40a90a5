#include "libcore/check/singular.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "libcore/base/text.hpp"

namespace hapgrid {

namespace {

constexpr std::size_t kPlaces = 3;  // of each quantity that are followed
constexpr std::size_t kSteps = 4;   // that are halved
constexpr int kHalvings = 10;       // of a shift while it climbs, from half a spacing on
constexpr int kMoves = 4;           // with each shift
// Over the last kWindow halvings, near 1/r it becomes 64 times as large, and near 1/sqrt(r) 8
// times. A smooth maximum that is a 64th of the spacing wide, with a shift of a 16th, grows by
// less.
constexpr int kWindow = 6;
constexpr double kGrowth = 6;
constexpr double kGrows = 1.2;  // by one halving: a snap on the way up lets it grow once
// A step is halved until it is a 4096th. Then a force that is continuous changes by less than this
// share of what it changed by at first, and of the largest force.
constexpr int kStepHalvings = 12;
constexpr double kShareLeft = 0.25;
constexpr double kShareOfForce = 0.1;

const char* name_of(int quantity) {
  static constexpr const char* kNames[] = {"force", "energy", "state"};
  return kNames[quantity];
}

double euclidean(const Vec3& v) { return std::hypot(v[0], v[1], v[2]); }
double apart(const Vec3& a, const Vec3& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}
Vec3 shifted(const Vec3& x, const Vec3& d) { return {x[0] + d[0], x[1] + d[1], x[2] + d[2]}; }

/// Keeps the largest `count`, one at each place.
template <class Entry>
void keep_largest(std::vector<Entry>& kept, Entry entry, double Entry::*size, std::size_t count) {
  for (Entry& other : kept)
    if (other.x == entry.x) {
      if (entry.*size > other.*size) other = std::move(entry);
      return;
    }
  if (kept.size() < count) {
    kept.push_back(std::move(entry));
    return;
  }
  auto least = std::min_element(kept.begin(), kept.end(),
                                [&](const Entry& a, const Entry& b) { return a.*size < b.*size; });
  if (entry.*size > (*least).*size) *least = std::move(entry);
}

}  // namespace

SingularPlaces::SingularPlaces(const GridSpec& spec, Model& model) : spec_(spec), model_(model) {
  const auto& n = spec.box.counts;
  low_ = spec.box.position(GridCoordinates{0, 0, 0});
  high_ = spec.box.position(GridCoordinates{n[0] - 1, n[1] - 1, n[2] - 1});
}

bool SingularPlaces::has(Quantity quantity) const {
  if (quantity == kForce) return spec_.stored.force || model_.has_force();
  return quantity == kState || spec_.stored.energy || model_.has_energy();
}

Vec3 SingularPlaces::force(const Vec3& x, const Row& row) const {
  if (!spec_.stored.force) return model_.force(x, row.data());
  const double* f = &row[spec_.force_offset()];
  return {f[0], f[1], f[2]};
}

double SingularPlaces::value(Quantity quantity, const Vec3& x, const Row& row) const {
  if (quantity == kForce) return euclidean(force(x, row));
  if (quantity == kEnergy)
    return std::abs(spec_.stored.energy ? row[spec_.energy_offset()]
                                        : model_.energy(x, row.data()));
  double most = 0;
  for (std::uint32_t c = 0; c < spec_.state_size; ++c) most = std::max(most, std::abs(row[c]));
  return most;
}

void SingularPlaces::visit(const Vec3& x, const Row& row) {
  for (int q = 0; q < kQuantities; ++q) {
    const auto quantity = static_cast<Quantity>(q);
    if (!has(quantity)) continue;
    const double size = value(quantity, x, row);
    if (std::isfinite(size)) keep_largest(largest_[q], Place{x, row, size}, &Place::value, kPlaces);
    if (quantity == kForce && std::isfinite(size)) largest_force_ = std::max(largest_force_, size);
  }
}

void SingularPlaces::pass(const Vec3& x, const Vec3& d, const Row& from, const Row& to) {
  if (!has(kForce)) return;
  const double change = apart(force(shifted(x, d), to), force(x, from));
  if (std::isfinite(change))
    keep_largest(steepest_, Step{x, d, from, to, change}, &Step::change, kSteps);
}

void SingularPlaces::offend(const Vec3& x, const std::string& what) {
  found_.offend([&] {
    return "at (" + rounded(x[0]) + ", " + rounded(x[1]) + ", " + rounded(x[2]) + "): " + what;
  });
}

/// Whether the HIP can be shifted there.
bool SingularPlaces::move(const Place& from, const Vec3& d, Quantity quantity, Place& to) {
  to.x = shifted(from.x, d);
  for (int a = 0; a < 3; ++a)
    if (to.x[a] < low_[a] || to.x[a] > high_[a]) return false;
  to.row.resize(spec_.row_size());
  if (!model_.convert(from.row.data(), from.x, d, to.row.data())) {
    to.value = NAN;
    return true;
  }
  to.value = value(quantity, to.x, to.row);
  return true;
}

void SingularPlaces::climb(Quantity quantity, Place place) {
  ++found_.counted;
  const char* const name = name_of(quantity);
  std::vector<double> sizes{place.value};
  double shift = spec_.box.spacing / 2;
  Place best, other;
  for (int halving = 0; halving < kHalvings; ++halving, shift /= 2) {
    for (int moves = 0; moves < kMoves; ++moves) {
      best.value = place.value;
      for (int side = 0; side < 6; ++side) {
        Vec3 d{};
        d[side / 2] = side % 2 == 0 ? shift : -shift;
        if (!move(place, d, quantity, other)) continue;
        if (!std::isfinite(other.value))
          return offend(other.x, std::string("near the largest ") + name + ", " +
                                     (model_.error().empty() ? std::string("it is not finite")
                                                             : "C fails: " + model_.error()));
        if (other.value > best.value) std::swap(best, other);
      }
      if (!(best.value > place.value)) break;
      std::swap(place, best);
    }
    sizes.push_back(place.value);
  }
  const double before = sizes[sizes.size() - 1 - kWindow];
  int times = 0;
  for (std::size_t i = sizes.size() - kWindow; i < sizes.size(); ++i)
    times += sizes[i] > kGrows * sizes[i - 1];
  if (!(place.value > kGrowth * before) || times < kWindow / 2) return;
  offend(place.x, std::string("the ") + name + " grows without end: " + rounded(before) +
                      " and, a " + rounded(2 * shift) + " nearer, " + rounded(place.value) +
                      "; make it finite there, or leave the place out of the box");
}

void SingularPlaces::halve(Step step) {
  ++found_.counted;
  const double at_first = step.change;
  Row middle(spec_.row_size());
  for (int k = 0; k < kStepHalvings; ++k) {
    const Vec3 half{step.d[0] / 2, step.d[1] / 2, step.d[2] / 2};
    const Vec3 x = shifted(step.x, half);
    if (!model_.convert(step.from.data(), step.x, half, middle.data())) return;
    const Vec3 between = force(x, middle);
    const double first = apart(between, force(step.x, step.from));
    const double second = apart(force(shifted(step.x, step.d), step.to), between);
    (first < second ? step.from : step.to) = middle;
    if (first < second) step.x = x;
    step.d = half;
    step.change = std::max(first, second);
  }
  if (!(step.change > kShareLeft * at_first && step.change > kShareOfForce * largest_force_))
    return;
  // A snap does not come back: what is behind it is another branch.
  const Vec3 there = shifted(step.x, step.d);
  if (!model_.convert(step.to.data(), there, {-step.d[0], -step.d[1], -step.d[2]}, middle.data()) ||
      !model_.equal(middle.data(), step.from.data()) ||
      apart(force(step.x, middle), force(step.x, step.from)) > 0.5 * step.change)
    return;
  offend(step.x, "the force jumps by " + rounded(step.change) + " N within a step of " +
                     rounded(euclidean(step.d)) +
                     " and back: it must be continuous where the model does not snap");
}

Findings SingularPlaces::search(std::chrono::steady_clock::time_point deadline) {
  const auto in_time = [&] { return std::chrono::steady_clock::now() < deadline; };
  for (int q = 0; q < kQuantities; ++q)
    for (Place& place : largest_[q])
      if (place.value > 0 && in_time()) climb(static_cast<Quantity>(q), std::move(place));
  for (Step& step : steepest_)
    if (in_time()) halve(std::move(step));
  return std::move(found_);
}

}  // namespace hapgrid
