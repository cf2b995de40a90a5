#include "libcore/model/plugin_model.hpp"

#include <dlfcn.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <sstream>
#include <utility>

#include "libcore/base/error.hpp"
#include "libcore/base/file.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/text.hpp"
#include "libcore/model/plugin.h"

namespace hapgrid {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kErrorSize = 512;

/// Why a plug-in failed: `error` is what it wrote, perhaps nothing, perhaps without a final NUL.
std::string reason(const char (&error)[kErrorSize]) {
  const std::size_t size = strnlen(error, kErrorSize);
  return size == 0 ? "no reason given" : printable_line({error, size}, kErrorSize);
}

/// Parameters as the C interface wants them; points into `parameters` and into itself.
class CParameters {
 public:
  explicit CParameters(const std::vector<Parameter>& parameters) {
    numbers_.reserve(parameters.size());
    texts_.resize(parameters.size());
    for (std::size_t i = 0; i < parameters.size(); ++i) add(parameters[i], texts_[i]);
  }
  const std::vector<hapgrid_parameter>& list() const { return list_; }

 private:
  void add(const Parameter& p, std::vector<const char*>& texts) {
    hapgrid_parameter c{p.key.c_str(), HAPGRID_BOOLEAN, 1, nullptr, nullptr};
    if (const auto* number = std::get_if<double>(&p.value)) {
      c.type = HAPGRID_NUMBER;
      c.numbers = number;
    } else if (const auto* flag = std::get_if<bool>(&p.value)) {
      numbers_.push_back(*flag ? 1 : 0);
      c.numbers = &numbers_.back();
    } else if (const auto* text = std::get_if<std::string>(&p.value)) {
      c.type = HAPGRID_TEXT;
      texts.push_back(text->c_str());
      c.texts = texts.data();
    } else if (const auto* array = std::get_if<std::vector<double>>(&p.value)) {
      c.type = HAPGRID_NUMBERS;
      c.count = array->size();
      c.numbers = array->data();
    } else {
      c.type = HAPGRID_TEXTS;
      for (const auto& s : std::get<std::vector<std::string>>(p.value)) texts.push_back(s.c_str());
      c.count = texts.size();
      c.texts = texts.data();
    }
    list_.push_back(c);
  }

  std::vector<hapgrid_parameter> list_;
  std::vector<double> numbers_;
  std::vector<std::vector<const char*>> texts_;
};

/// @throw ModelError
std::vector<Torsion> torsions_of(const hapgrid_model_table& table, const hapgrid_model* model,
                                 const hapgrid_model_info& in) {
  if (in.torsions > kMaxTorsions)
    throw ModelError(format("{} torsions; {} are possible", in.torsions, kMaxTorsions));
  std::vector<hapgrid_torsion> given(in.torsions);
  table.torsions(model, given.data());
  std::vector<Torsion> torsions;
  for (hapgrid_torsion& t : given) {
    t.name[sizeof t.name - 1] = '\0';
    torsions.push_back({{}, printable_line(t.name)});
    for (int k = 0; k < 4; ++k) {
      torsions.back().spheres[k] = t.spheres[k];
      if (!table.shape || t.spheres[k] >= in.spheres)
        throw ModelError(format("torsion {} has a sphere that is not there", torsions.back().name));
    }
  }
  return torsions;
}

/// @throw ModelError
ModelInfo info_of(const hapgrid_model_table& table, const hapgrid_model* model,
                  const Stored& store) {
  hapgrid_model_info in{};
  table.info(model, &in);
  for (char* unit : {in.tolerance_unit, in.length_unit, in.energy_unit})
    unit[sizeof in.tolerance_unit - 1] = '\0';
  in.version[sizeof in.version - 1] = '\0';
  ModelInfo info;
  info.state_size = in.state_size;
  info.d_max = in.d_max;
  info.tolerance = in.tolerance;
  info.tolerance_unit = in.tolerance_unit;
  info.length_unit = in.length_unit;
  info.energy_unit = in.energy_unit;
  info.version = in.version;
  info.force_scale = in.force_scale;
  info.processes = in.processes;
  info.hip_radius = in.hip_radius;
  info.stored = {(in.stored & HAPGRID_STORE_FORCE) != 0, (in.stored & HAPGRID_STORE_ENERGY) != 0,
                 (in.stored & HAPGRID_STORE_SHAPE) != 0};
  if (in.stored & ~std::uint32_t{HAPGRID_STORE_FORCE | HAPGRID_STORE_ENERGY | HAPGRID_STORE_SHAPE})
    throw ModelError("info.stored has unknown bits");
  if ((info.stored.force && !table.force) || (info.stored.energy && !table.energy) ||
      (info.stored.shape && !table.shape))
    throw ModelError("info.stored names a function that is NULL");
  if (table.periods && in.state_size > 0 && in.state_size <= kMaxStateSize) {
    info.equality.periods.resize(in.state_size);
    table.periods(model, info.equality.periods.data());
    if (!info.equality.fits_periods(in.state_size))
      throw ModelError("a period is negative, or an orientation has not six components");
    std::vector<double>& periods = info.equality.periods;
    if (std::all_of(periods.begin(), periods.end(), [](double p) { return p == 0; }))
      periods.clear();  // as of a model that has no such function
  }
  if (table.shape) {
    require_possible_shape(in.spheres);
    std::vector<hapgrid_sphere> spheres(in.spheres);
    table.spheres(model, spheres.data());
    for (hapgrid_sphere& s : spheres) {
      s.label[sizeof s.label - 1] = '\0';
      info.spheres.push_back(
          {s.radius, {s.colour[0], s.colour[1], s.colour[2]}, printable_line(s.label)});
    }
  }
  if (table.torsions && in.torsions > 0) info.torsions = torsions_of(table, model, in);
  if (info.stored.shape && info.spheres.empty())
    throw ModelError("info.stored names a shape without spheres");
  if (store.force && !table.force) throw ModelError("has no force that could be stored");
  if (store.energy && !table.energy) throw ModelError("has no energy that could be stored");
  if (store.shape && info.spheres.empty()) throw ModelError("has no shape that could be stored");
  info.stored.force |= store.force;
  info.stored.energy |= store.energy;
  info.stored.shape |= store.shape;
  info.validate();
  return info;
}

/// One for the program: create() runs alone, as the libraries that plug-ins use want it (Open Babel
/// reads one file at a time), and so does every call of a model that shares data with others.
std::mutex& turn() {
  static std::mutex mutex;
  return mutex;
}

using OwnedModel = std::unique_ptr<hapgrid_model, void (*)(hapgrid_model*)>;

class PluginModel final : public Model {
 public:
  PluginModel(std::shared_ptr<void> library, const hapgrid_model_table& table, OwnedModel model,
              const Stored& store)
      : Model(info_of(table, model.get(), store)),
        library_(std::move(library)),
        table_(table),
        model_(std::move(model)),
        centres_(info().stored.shape ? 3 * info().spheres.size() : 0) {}

  std::vector<double> known_states(const Vec3& x) override;
  bool convert(const double* s, const Vec3& x, const Vec3& d, double* row) override;
  bool complete(const Vec3& x, double* row) override;

  bool equal(const double* a, const double* b) const override {
    const auto lock = my_turn();
    return table_.equal(model_.get(), a, b) != 0;
  }
  bool has_force() const override { return table_.force != nullptr; }
  bool has_energy() const override { return table_.energy != nullptr; }
  bool has_shape() const override { return table_.shape != nullptr; }
  Vec3 force(const Vec3& x, const double* s) const override {
    Vec3 f{0, 0, 0};
    const auto lock = my_turn();
    table_.force(model_.get(), x.data(), s, f.data());
    return f;
  }
  double energy(const Vec3& x, const double* s) const override {
    const auto lock = my_turn();
    return table_.energy(model_.get(), x.data(), s);
  }
  bool has_own_energy() const override { return table_.own_energy != nullptr; }
  double own_energy(const double* s) const override {
    const auto lock = my_turn();
    return table_.own_energy(model_.get(), s);
  }
  bool has_check() const override { return table_.check != nullptr; }
  std::vector<std::string> check() override {
    std::vector<std::string> problems;
    table_.check(
        model_.get(),
        [](void* list, const char* line) {
          static_cast<std::vector<std::string>*>(list)->push_back(
              printable_line({line, strnlen(line, kErrorSize)}, kErrorSize));
        },
        &problems);
    return problems;
  }
  void shape(const Vec3& x, const double* s, std::span<float> centres) const override {
    const auto lock = my_turn();
    table_.shape(model_.get(), x.data(), s, centres.data());
  }

 private:
  /// Held during a call of a plug-in whose models share data; else nothing.
  std::unique_lock<std::mutex> my_turn() const {
    return info().processes == 1 ? std::unique_lock(turn()) : std::unique_lock<std::mutex>();
  }

  std::shared_ptr<void> library_;  // declared first: it outlives the model
  const hapgrid_model_table& table_;
  OwnedModel model_;
  std::vector<float> centres_;  // a shape on its way into a row
};

std::vector<double> PluginModel::known_states(const Vec3& x) {
  char error[kErrorSize] = "";
  std::vector<double> states(state_size());
  for (std::size_t capacity = 1;;) {
    std::size_t count = 0;
    const auto lock = my_turn();
    if (table_.known_states(model_.get(), x.data(), states.data(), capacity, &count, error,
                            sizeof error) != 0)
      throw ModelError("known states: " + reason(error));
    if (count > static_cast<std::size_t>(kMaxLevels))
      throw ModelError(
          format("known states: {} states at one point, the limit is {}", count, kMaxLevels));
    states.resize(count * state_size());
    if (count <= capacity) return states;
    capacity = count;
  }
}

bool PluginModel::convert(const double* s, const Vec3& x, const Vec3& d, double* row) {
  char error[kErrorSize];
  error[0] = '\0';
  auto lock = my_turn();
  const int failed = table_.convert(model_.get(), s, x.data(), d.data(), row, error, sizeof error);
  if (lock.owns_lock()) lock.unlock();
  if (failed != 0) {
    error_ = reason(error);
    return false;
  }
  for (std::uint32_t c = 0; c < state_size(); ++c) {
    if (!std::isfinite(row[c])) {
      error_ = format("component {} of the state reached is not finite", c);
      return false;
    }
  }
  return row_size() == state_size() || complete({x[0] + d[0], x[1] + d[1], x[2] + d[2]}, row);
}

bool PluginModel::complete(const Vec3& x, double* row) {
  double* out = row + state_size();
  const char* what = nullptr;
  const auto append = [&](double value, const char* name) {
    if (!std::isfinite(value)) what = name;
    *out++ = value;
  };
  const Stored& kept = info().stored;
  if (kept.force)
    for (const double f : force(x, row)) append(f, "force");
  if (kept.energy) append(energy(x, row), "energy");
  if (kept.shape) {
    shape(x, row, centres_);
    for (const float c : centres_) append(c, "shape");
  }
  if (what) error_ = format("the {} is not finite", what);
  return what == nullptr;
}

}  // namespace

std::vector<fs::path> model_path() {
  std::vector<fs::path> directories;
  if (const char* path = std::getenv("HAPGRID_MODEL_PATH")) {
    std::istringstream entries(path);
    for (std::string entry; std::getline(entries, entry, ':');)
      if (!entry.empty()) directories.emplace_back(entry);
  }
  if (const fs::path own = own_folder(); !own.empty())
    directories.push_back(own.parent_path() / "models");
  return directories;
}

Plugin::Plugin(const std::string& name, const std::vector<fs::path>& directories) : name_(name) {
  if (!is_valid_name(name))
    throw ModelError(
        format("model '{}': a plug-in's name has only letters, digits, '-' and '_'; "
               "HAPGRID_MODEL_PATH says where NAME.so is",
               printable_line(name)));
  std::string searched;
  fs::path file;
  for (const fs::path& directory : directories) {
    searched += (searched.empty() ? "" : ", ") + directory.string();
    std::error_code ignored;
    if (fs::exists(directory / (name + ".so"), ignored)) {
      file = fs::absolute(directory / (name + ".so"));
      break;
    }
  }
  if (file.empty())
    throw ModelError(
        format("model {}: no plug-in {}.so in: {} (add its folder to HAPGRID_MODEL_PATH)", name,
               name, searched));
  void* handle = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!handle) throw ModelError(format("model {}: {}", name, printable_line(dlerror())));
  library_ = std::shared_ptr<void>(handle, [](void* h) { dlclose(h); });
  using Entry = const hapgrid_model_table* (*)();
  const auto entry = reinterpret_cast<Entry>(dlsym(handle, "hapgrid_model_plugin"));
  if (!entry)
    throw ModelError(
        format("model {}: {} is no hapgrid plug-in (it has no function hapgrid_model_plugin)", name,
               file.string()));
  table_ = entry();
  if (!table_) throw ModelError(format("model {}: hapgrid_model_plugin() returned NULL", name));
  if (table_->interface_version != HAPGRID_MODEL_INTERFACE)
    throw ModelError(format(
        "model {}: {} has interface version {}, this hapgrid has {}; build the plug-in again", name,
        file.string(), table_->interface_version, HAPGRID_MODEL_INTERFACE));
  if (!table_->create || !table_->destroy || !table_->info || !table_->known_states ||
      !table_->convert || !table_->equal)
    throw ModelError(format("model {}: a required function of the plug-in's table is NULL", name));
  if (!table_->spheres != !table_->shape)
    throw ModelError(
        format("model {}: one of spheres() and shape() is NULL, the other is not", name));
  if (table_->summary) summary_ = printable_line(table_->summary);
}

std::unique_ptr<Model> Plugin::create(const std::vector<Parameter>& parameters,
                                      const Stored& store) const {
  const CParameters c(parameters);
  char error[kErrorSize] = "";
  OwnedModel model(nullptr, table_->destroy);
  {
    const std::scoped_lock one_at_a_time(turn());
    model.reset(table_->create(c.list().data(), c.list().size(), error, sizeof error));
  }
  try {
    if (!model) throw ModelError(reason(error));
    return std::make_unique<PluginModel>(library_, *table_, std::move(model), store);
  } catch (const ModelError& e) {
    throw ModelError(format("model {}: {}", name_, e.what()));
  }
}

}  // namespace hapgrid
