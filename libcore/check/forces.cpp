#include "libcore/check/forces.hpp"

#include <array>
#include <bit>
#include <deque>
#include <optional>

#include "libcore/base/parallel.hpp"

namespace hapgrid {

namespace {

/// Force and energy of a record; of energies that are not known 0.
struct Field {
  Vec3 force{0, 0, 0};
  double energy = 0;

  /// To the last bit: also the sign of a 0 reaches the force that play sends. Number by number:
  /// a processor that loads two numbers at once waits until both stores before it have ended.
  bool is_same(const Field& other) const {
    const auto same = [](double a, double b) {
      return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
    };
    return same(energy, other.energy) && same(force[0], other.force[0]) &&
           same(force[1], other.force[1]) && same(force[2], other.force[2]);
  }
};

/// What asks the records' fields, in threads.
class Survey {
 public:
  Survey(const Grid& grid, const MakeModel& create, int threads) : grid_(grid) {
    for (int t = 0; t < threads; ++t)
      fields_.emplace_back(grid.spec(), create, /*wants_shape=*/false);
    scale_ = fields_.front().force_scale();
    has_energy_ = fields_.front().has_energy() && scale_ > 0;
  }

  bool has_energy() const { return has_energy_; }

  /// Calls use(r, field) for each record, in blocks of a multiple of 64.
  template <class Use>
  void ask(const Use& use) {
    for_each_with_own(blocks(), fields_, [&](const Fields& own, std::size_t block) {
      const std::size_t end = std::min<std::size_t>(grid_.records(), (block + 1) * kBlock);
      CoordinatesOfRun at(grid_.box());
      for (auto r = static_cast<RecordIndex>(block * kBlock); r < end; ++r)
        use(r, ask(own, r, grid_.box().position(at(grid_.point(r)))));
    });
  }
  /// For each of some records.
  template <class Use>
  void ask_some(const RankedBits& some, const Use& use) {
    for_each_with_own(blocks(), fields_, [&](const Fields& own, std::size_t block) {
      constexpr std::size_t kWords = kBlock / 64;
      some.for_each(block * kWords, std::min(some.words(), (block + 1) * kWords),
                    [&](std::size_t r) {
                      const auto record = static_cast<RecordIndex>(r);
                      use(record, ask(own, record, position(record)));
                    });
    });
  }
  Field ask(RecordIndex r) const { return ask(fields_.front(), r, position(r)); }

 private:
  static constexpr std::size_t kBlock = 1 << 12;

  std::size_t blocks() const { return (std::size_t{grid_.records()} + kBlock - 1) / kBlock; }
  Vec3 position(RecordIndex r) const { return grid_.box().position(grid_.point(r)); }
  Field ask(const Fields& own, RecordIndex r, const Vec3& x) const {
    const auto row = grid_.row(r);
    return {own.force(x, row), has_energy_ ? scale_ * own.energy(x, row) : 0};
  }

  const Grid& grid_;
  std::deque<Fields> fields_;  // one a thread
  double scale_ = 0;
  bool has_energy_ = false;
};

/// What records without a force share, as one of the box's corners has it.
std::optional<Field> free_field(const Grid& grid, const Survey& survey) {
  const GridCoordinates& n = grid.box().counts;
  for (unsigned corner = 0; corner < 8; ++corner) {
    GridCoordinates c{};
    for (int a = 0; a < 3; ++a) c[a] = corner >> a & 1 ? n[a] - 1 : 0;
    const PointIndex p = grid.box().index(c);
    if (grid.levels(p) == 0) continue;
    const Field field = survey.ask(grid.first(p));
    if (Field{{0, 0, 0}, field.energy}.is_same(field)) return field;
  }
  return std::nullopt;
}

}  // namespace

bool has_force(const GridSpec& spec, const Model& model) {
  return spec.stored.force || model.has_force();
}

RecordFields record_fields(const Grid& grid, const MakeModel& create, int threads) {
  Survey survey(grid, create, threads);
  RecordFields found;
  found.force.resize(grid.records());
  if (survey.has_energy()) found.energy.resize(grid.records());
  survey.ask([&](RecordIndex r, const Field& field) {
    found.force[r] = field.force;
    if (survey.has_energy()) found.energy[r] = field.energy;
  });
  return found;
}

RecordFields shared_fields(const Grid& grid, const MakeModel& create, int threads) {
  Survey survey(grid, create, threads);
  const std::optional<Field> shared = free_field(grid, survey);
  if (!shared) return record_fields(grid, create, threads);
  std::vector<std::uint64_t> own(std::size_t{grid.records()} / 64 + 1);
  survey.ask([&](RecordIndex r, const Field& field) {
    if (!field.is_same(*shared)) own[r / 64] |= std::uint64_t{1} << r % 64;  // of this block alone
  });
  RecordFields found;
  found.slots = RecordSlots(RankedBits(own));
  const RankedBits& bits = found.slots.own();
  found.force.resize(found.slots.size(grid.records()));
  if (survey.has_energy()) found.energy.resize(found.force.size());
  const auto put = [&](std::size_t slot, const Field& field) {
    found.force[slot] = field.force;
    if (survey.has_energy()) found.energy[slot] = field.energy;
  };
  put(0, *shared);
  // They are few: to ask them again takes less than to keep what was answered.
  survey.ask_some(bits, [&](RecordIndex r, const Field& field) { put(found.slots[r], field); });
  return found;
}

}  // namespace hapgrid
