#include "tools/apps/table/lattice.hpp"

#include <charconv>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string_view>

namespace hapgrid::table {

namespace {

class Words {
 public:
  Words(const std::string& text, const std::string& name) : rest_(text), name_(name) {}

  [[noreturn]] void fail(const std::string& what) const {
    throw std::runtime_error(name_ + ": " + what);
  }
  /// The next word; empty at the end.
  std::string_view next() {
    const std::size_t begin = rest_.find_first_not_of(" \t\r\n");
    if (begin == std::string_view::npos) return rest_ = {};
    rest_.remove_prefix(begin);
    const std::string_view word = rest_.substr(0, rest_.find_first_of(" \t\r\n"));
    rest_.remove_prefix(word.size());
    return word;
  }
  /// @param what the number is, for the message.
  double number(const char* what, bool may_be_missing = false) {
    const std::string_view word = next();
    double value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (word.empty()) fail(std::string("it ends before all ") + what + " are there");
    if (error != std::errc() || end != word.data() + word.size() ||
        (!std::isfinite(value) && !(may_be_missing && std::isnan(value))))
      fail("'" + std::string(word.substr(0, 20)) + "' among the " + what + " is no number");
    return value;
  }
  Vector vector(const char* what) {
    Vector v;
    for (double& c : v) c = number(what);
    return v;
  }

 private:
  std::string_view rest_;
  const std::string& name_;
};

void read_counts(Words& words, Lattice& lattice) {
  std::size_t all = 1;
  for (std::size_t& count : lattice.counts) {
    const double n = words.number("counts");
    if (!(n >= Spline::kLeastPoints && n <= kMaxValues && n == std::floor(n)))
      words.fail("each axis needs a whole number of points, and at least 4");
    count = static_cast<std::size_t>(n);
    all *= count;
    if (all > kMaxValues) words.fail("it has more than 16,777,216 values");
  }
}

void invert(const Words& words, Lattice& lattice) {
  const auto& a = lattice.axes;
  double size = 1;
  for (const Vector& axis : a) size *= length(axis);
  const double volume = dot(a[0], cross(a[1], a[2]));
  if (!(std::abs(volume) > 1e-6 * size)) words.fail("its axes lie in one plane");
  for (int k = 0; k < 3; ++k) {
    lattice.inverse[k] = cross(a[(k + 1) % 3], a[(k + 2) % 3]);
    for (double& c : lattice.inverse[k]) c /= volume;
  }
}

}  // namespace

Vector Lattice::coordinates(const double* x) const {
  const Vector from = minus({x[0], x[1], x[2]}, origin);
  return {dot(inverse[0], from), dot(inverse[1], from), dot(inverse[2], from)};
}

Vector Lattice::place(const Spline::Counts& point) const {
  Vector x = origin;
  for (int a = 0; a < 3; ++a)
    for (int c = 0; c < 3; ++c) x[c] += static_cast<double>(point[a]) * axes[a][c];
  return x;
}

Vector Lattice::gradient(const Vector& by_lattice) const {
  Vector g{};
  for (int a = 0; a < 3; ++a)
    for (int c = 0; c < 3; ++c) g[c] += inverse[a][c] * by_lattice[a];
  return g;
}

Lattice read_lattice(const std::string& text, const std::string& name) {
  Words words(text, name);
  if (words.next() != "hapgrid-table") words.fail("it is no table: `hapgrid table` writes one");
  Lattice lattice;
  int axes = 0;
  bool counts = false, origin = false;
  for (std::string_view key = words.next(); key != "values"; key = words.next()) {
    if (key == "counts") {
      read_counts(words, lattice);
      counts = true;
    } else if (key == "origin") {
      lattice.origin = words.vector("numbers of the origin");
      origin = true;
    } else if (key == "axis" && axes < 3) {
      lattice.axes[axes++] = words.vector("numbers of the axes");
    } else if (key == "atom") {
      std::string label(words.next().substr(0, 7));
      lattice.atoms.push_back({std::move(label), words.vector("coordinates of atoms")});
    } else {
      words.fail("'" + std::string(key.substr(0, 20)) +
                 "' where counts, origin, three times axis, atom or values is due");
    }
  }
  if (!counts || !origin || axes < 3) words.fail("counts, origin or an axis is missing");
  invert(words, lattice);
  const std::size_t all = lattice.counts[0] * lattice.counts[1] * lattice.counts[2];
  lattice.values.reserve(std::min(all, text.size() / 2));
  for (std::size_t i = 0; i < all; ++i) lattice.values.push_back(words.number("values", true));
  if (!words.next().empty()) words.fail("it has more values than its counts say");
  return lattice;
}

void look_of(const std::string& element, float& radius, float colour[3]) {
  struct Look {
    const char* symbol;
    float radius, colour[3];
  };
  static constexpr Look kLooks[] = {
      {"H", 1.2F, {0.9F, 0.9F, 0.9F}},   {"C", 1.7F, {0.45F, 0.45F, 0.45F}},
      {"N", 1.55F, {0.2F, 0.3F, 0.9F}},  {"O", 1.52F, {0.9F, 0.15F, 0.1F}},
      {"F", 1.47F, {0.5F, 0.8F, 0.3F}},  {"P", 1.8F, {1.0F, 0.5F, 0.0F}},
      {"S", 1.8F, {0.9F, 0.8F, 0.2F}},   {"Cl", 1.75F, {0.1F, 0.9F, 0.1F}},
      {"Br", 1.85F, {0.6F, 0.2F, 0.1F}}, {"I", 1.98F, {0.5F, 0.0F, 0.5F}}};
  radius = 1.8F;
  colour[0] = 0.8F, colour[1] = 0.4F, colour[2] = 0.7F;
  for (const Look& look : kLooks)
    if (element == look.symbol) {
      radius = look.radius;
      for (int a = 0; a < 3; ++a) colour[a] = look.colour[a];
    }
}

}  // namespace hapgrid::table
