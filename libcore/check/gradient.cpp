#include "libcore/check/gradient.hpp"

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libcore/base/format.hpp"
#include "libcore/base/text.hpp"
#include "libcore/check/force_check.hpp"
#include "libcore/check/invariants.hpp"
#include "libcore/follow/record_fields.hpp"
#include "libcore/grid/vec3.hpp"

namespace hapgrid {

namespace {

constexpr std::size_t kAsked = 100;    // records, each with up to 12 conversions
constexpr int kHalvings = 6;           // of the spacing, until the force shows
constexpr std::uint64_t kFewest = 10;  // predictions that tell

/// Every k-th of the records, so that kAsked are left.
std::vector<RecordIndex> some_of(std::span<const RecordIndex> records) {
  std::vector<RecordIndex> some;
  for (std::size_t i = 0; i < std::min(kAsked, records.size()); ++i)
    some.push_back(records[records.size() <= kAsked ? i : i * records.size() / kAsked]);
  return some;
}

/// What the model says of its force in the states of records.
Check ask_model(const Grid& grid, std::span<const RecordIndex> records, Model& model) {
  ForceCheck forces(grid.spec(), model);
  Findings finite;
  for (const RecordIndex r : records)
    if (is_finite(grid.state(r)))
      forces.try_at(grid.box().position(grid.point(r)), grid.state(r), finite);
  return forces.gradient();
}

/// Predicts the forces of records from places `h` away, where the model is asked, along the axes on
/// which it comes back.
Agreement agreement_at(const Grid& grid, std::span<const RecordIndex> records, Model& model,
                       double h) {
  const Fields fields(grid.spec(), model);
  const double scale = fields.force_scale();
  Agreement found;
  std::vector<double> here(grid.spec().row_size()), back(here);
  std::vector<double> beside[2] = {here, here};
  for (const RecordIndex r : records) {
    const Vec3 x = grid.box().position(grid.point(r));
    for (int a = 0; a < 3; ++a) {
      Vec3 step{0, 0, 0};
      step[a] = h;
      bool is_branch = true;
      for (int side = 0; side < 2 && is_branch; ++side) {
        const Vec3 d = (side ? 1.0 : -1.0) * step;
        is_branch = model.convert(grid.state(r).data(), x, d, beside[side].data()) &&
                    model.convert(beside[side].data(), x + d, -1 * d, back.data()) &&
                    model.equal(back.data(), grid.state(r).data());
      }
      if (!is_branch) continue;
      here.assign(grid.row(r).begin(), grid.row(r).end());
      const Vec3 low = x - step, high = x + step;
      found.add(fields.force(x, here)[a], fields.force(low, beside[0])[a],
                fields.force(high, beside[1])[a], scale * fields.energy(low, beside[0]),
                scale * fields.energy(high, beside[1]), h);
    }
  }
  found.finish();
  return found;
}

/// The largest spacing, of half the grid's, a quarter and so on, that shows the force of this
/// model.
std::optional<double> fine_enough(const Grid& grid, std::span<const RecordIndex> records,
                                  Model& model) {
  double h = grid.box().spacing;
  for (int k = 0; k < kHalvings; ++k) {
    h /= 2;
    const Agreement found = agreement_at(grid, records, model, h);
    if (found.predictions >= kFewest && found.is_sure()) return h;
  }
  return std::nullopt;
}

}  // namespace

Check check_gradient(const Grid& grid, const RecordFields& fields,
                     std::span<const RecordIndex> records, const MakeModel& make_model) {
  const Agreement found = agreement(grid, fields);
  Check check{"gradient",
              "forces",
              "the force is not the gradient of the energy, which play interpolates else",
              {},
              /*is_note=*/true};
  check.found.counted = found.predictions;
  check.figures = {
      {"force", found.force, "N", "of the records, root mean square"},
      {"error by energy", found.by_energy, "N", "of forces predicted from energies and forces"},
      {"error by forces", found.by_forces, "N", "of forces predicted from forces alone"}};
  if (found.by_forces > 0)
    check.figures.push_back(
        {"ratio", found.by_energy / found.by_forces, "",
         "of these errors; play takes the energy where it is below 1, or where the error by energy "
         "is at most 5 % of the force. Beyond 0.5 the grid does not resolve the force"});
  const std::vector<RecordIndex> asked = some_of(records);
  if (!make_model || asked.empty()) {
    if (found.predictions > 0 && !found.is_good())
      check.found.offend([] { return "play interpolates the forces of the records"; });
    return check;
  }
  const std::unique_ptr<Model> model = make_model();
  if (Check answer = ask_model(grid, asked, *model); answer.found.offenders > 0) {
    check.is_note = false;
    check.meaning = answer.meaning;
    check.found.offenders = answer.found.offenders;
    check.found.first = std::move(answer.found.first);
  } else if (answer.found.counted > 0 && found.predictions > 0 && !found.is_sure()) {
    const std::optional<double> h = fine_enough(grid, asked, *model);
    const std::string unit =
        grid.spec().length_unit.empty() ? "" : " " + printable_line(grid.spec().length_unit);
    check.remark = "the force is right, the grid is too coarse for the energy's gradient" +
                   (h ? format(": h = {}{} would do", rounded(*h), unit) : "");
    check.meaning = check.remark;
    check.found.offend([&] {
      return found.is_good() ? "play interpolates the energy"
                             : "play interpolates the forces of the records";
    });
  }
  return check;
}

}  // namespace hapgrid
