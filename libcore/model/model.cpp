#include "libcore/model/model.hpp"

#include <dlfcn.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <utility>

#include "libcore/base/error.hpp"
#include "libcore/base/text.hpp"

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

}  // namespace

bool is_plain(const std::string& name) {
  if (name.empty() || name.size() > 100 || name[0] == '-') return false;
  for (const char c : name)
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '-' && c != '_') return false;
  return true;
}

std::vector<fs::path> model_path(const std::vector<std::string>& given) {
  std::vector<fs::path> directories(given.begin(), given.end());
  if (const char* path = std::getenv("HAPGRID_MODEL_PATH")) {
    std::istringstream entries(path);
    for (std::string entry; std::getline(entries, entry, ':');)
      if (!entry.empty()) directories.emplace_back(entry);
  }
  std::error_code ignored;
  const fs::path self = fs::read_symlink("/proc/self/exe", ignored);
  if (!ignored) directories.push_back(self.parent_path().parent_path() / "models");
  return directories;
}

Plugin::Plugin(const std::string& name, const std::vector<fs::path>& directories) : name_(name) {
  if (!is_plain(name))
    throw ModelError("model '" + printable_line(name) +
                     "': a plug-in's name has only letters, digits, '-' and '_'");
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
    throw ModelError("model " + name + ": no plug-in " + name + ".so in: " + searched +
                     " (add a directory with --model-path or HAPGRID_MODEL_PATH)");
  void* handle = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!handle) throw ModelError("model " + name + ": " + printable_line(dlerror()));
  library_ = std::shared_ptr<void>(handle, [](void* h) { dlclose(h); });
  using Entry = const hapgrid_model_table* (*)();
  const auto entry = reinterpret_cast<Entry>(dlsym(handle, "hapgrid_model_plugin"));
  if (!entry)
    throw ModelError("model " + name + ": " + file.string() +
                     " is no hapgrid plug-in (it has no function hapgrid_model_plugin)");
  table_ = entry();
  if (!table_) throw ModelError("model " + name + ": hapgrid_model_plugin() returned NULL");
  if (table_->interface_version != HAPGRID_MODEL_INTERFACE)
    throw ModelError("model " + name + ": " + file.string() + " has interface version " +
                     std::to_string(table_->interface_version) + ", this hapgrid has " +
                     std::to_string(HAPGRID_MODEL_INTERFACE) + "; build the plug-in again");
  if (!table_->create || !table_->destroy || !table_->info || !table_->known_states ||
      !table_->convert || !table_->equal)
    throw ModelError("model " + name + ": a required function of the plug-in's table is NULL");
  if (!table_->spheres != !table_->shape)
    throw ModelError("model " + name + ": one of spheres() and shape() is NULL, the other is not");
  if (table_->summary) summary_ = printable_line(table_->summary);
}

Model Plugin::create(const std::vector<Parameter>& parameters) const {
  const CParameters c(parameters);
  char error[kErrorSize] = "";
  hapgrid_model* model = table_->create(c.list().data(), c.list().size(), error, sizeof error);
  if (!model) throw ModelError("model " + name_ + ": " + reason(error));
  return Model(*this, model);
}

Model::Model(const Plugin& plugin, hapgrid_model* model)
    : library_(plugin.library_), table_(plugin.table_), model_(model, table_->destroy), info_{} {
  table_->info(model, &info_);
  for (char* unit : {info_.tolerance_unit, info_.length_unit, info_.energy_unit})
    unit[sizeof info_.tolerance_unit - 1] = '\0';
  const std::string who = "model " + plugin.name() + ": ";
  if (info_.state_size == 0 || info_.state_size > kMaxStateSize)
    throw ModelError(who + "a state of " + std::to_string(info_.state_size) + " components; 1 to " +
                     std::to_string(kMaxStateSize) + " are possible");
  if (!(info_.d_max > 0)) throw ModelError(who + "d_max is not positive");
  if (!table_->shape) info_.spheres = 0;
  if (info_.spheres > kMaxSpheres)
    throw ModelError(who + "a shape of " + std::to_string(info_.spheres) + " spheres; " +
                     std::to_string(kMaxSpheres) + " are possible");
  if (!std::isfinite(info_.tolerance) || info_.tolerance < 0)
    throw ModelError(who + "the tolerance is negative or not finite");
  if (info_.stored &
      ~std::uint32_t{HAPGRID_STORE_FORCE | HAPGRID_STORE_ENERGY | HAPGRID_STORE_SHAPE})
    throw ModelError(who + "info.stored has unknown bits");
  if (!std::isfinite(info_.hip_radius) || info_.hip_radius < 0)
    throw ModelError(who + "the radius of the HIP is negative or not finite");
  const Stored kept = stored();
  if ((kept.force && !has_force()) || (kept.energy && !has_energy()) ||
      (kept.shape && !has_shape()))
    throw ModelError(who + "info.stored names a function that is NULL");
  if (kept.shape && info_.spheres == 0)
    throw ModelError(who + "info.stored names a shape without spheres");
  row_size_ = info_.state_size + (kept.force ? 3 : 0) + (kept.energy ? 1 : 0) +
              (kept.shape ? 3 * info_.spheres : 0);
  if (kept.shape) centres_.resize(std::size_t{3} * info_.spheres);
  for (const Sphere& sphere : spheres())
    if (!std::isfinite(sphere.radius) || sphere.radius < 0)
      throw ModelError(who + "a sphere whose radius is negative or not finite");
}

Model::Model(std::unique_ptr<ProcessModel> process)
    : table_(&process->table()),
      model_(reinterpret_cast<hapgrid_model*>(process.get()),
             [](hapgrid_model* model) { delete reinterpret_cast<ProcessModel*>(model); }),
      process_(process.release()),
      info_{} {
  const Description& d = process_->description();
  info_.state_size = d.state_size;
  if (d.stored.force) info_.stored |= HAPGRID_STORE_FORCE;
  if (d.stored.energy) info_.stored |= HAPGRID_STORE_ENERGY;
  if (d.stored.shape) info_.stored |= HAPGRID_STORE_SHAPE;
  info_.d_max = d.d_max;
  info_.tolerance = d.tolerance;
  d.tolerance_unit.copy(info_.tolerance_unit, sizeof info_.tolerance_unit - 1);
  d.length_unit.copy(info_.length_unit, sizeof info_.length_unit - 1);
  d.energy_unit.copy(info_.energy_unit, sizeof info_.energy_unit - 1);
  info_.force_scale = d.force_scale;
  info_.hip_radius = d.hip_radius;
  info_.spheres = static_cast<std::uint32_t>(d.spheres.size());
  row_size_ = d.row_size();
}

Stored Model::stored() const {
  return {(info_.stored & HAPGRID_STORE_FORCE) != 0, (info_.stored & HAPGRID_STORE_ENERGY) != 0,
          (info_.stored & HAPGRID_STORE_SHAPE) != 0};
}

std::vector<Sphere> Model::spheres() const {
  if (process_) return process_->description().spheres;
  std::vector<hapgrid_sphere> written(info_.spheres);
  if (has_shape()) table_->spheres(model_.get(), written.data());
  std::vector<Sphere> spheres;
  for (hapgrid_sphere& s : written) {
    s.label[sizeof s.label - 1] = '\0';
    spheres.push_back({s.radius, {s.colour[0], s.colour[1], s.colour[2]}, printable_line(s.label)});
  }
  return spheres;
}

std::vector<double> Model::known_states(const Vec3& x) const {
  char error[kErrorSize] = "";
  std::vector<double> states(info_.state_size);
  if (process_) {
    const std::string why = process_->known_states(x, states);
    if (!why.empty()) throw ModelError("known states: " + why);
    return states;
  }
  for (std::size_t capacity = 1;;) {
    std::size_t count = 0;
    if (table_->known_states(model_.get(), x.data(), states.data(), capacity, &count, error,
                             sizeof error) != 0)
      throw ModelError("known states: " + reason(error));
    if (count > static_cast<std::size_t>(kMaxLevels))
      throw ModelError("known states: " + std::to_string(count) +
                       " states at one point, the limit is " + std::to_string(kMaxLevels));
    states.resize(count * info_.state_size);
    if (count <= capacity) return states;
    capacity = count;
  }
}

bool Model::convert(const double* s, const Vec3& x, const Vec3& d, double* row) {
  if (process_) {
    bool given = false;
    process_->convert(
        [&](Conversion& conversion, bool) {
          conversion = {s, x, d, row, 0};
          return !std::exchange(given, true);
        },
        [this](const Conversion&, const std::string& error) { error_ = error; });
    return error_.empty();
  }
  char error[kErrorSize];
  error[0] = '\0';
  if (table_->convert(model_.get(), s, x.data(), d.data(), row, error, sizeof error) != 0) {
    error_ = reason(error);
    return false;
  }
  for (std::uint32_t c = 0; c < info_.state_size; ++c) {
    if (!std::isfinite(row[c])) {
      error_ = "component " + std::to_string(c) + " of the state reached is not finite";
      return false;
    }
  }
  return row_size_ == info_.state_size || complete({x[0] + d[0], x[1] + d[1], x[2] + d[2]}, row);
}

bool Model::complete(const Vec3& x, double* row) {
  if (process_) {
    error_ = process_->evaluate(x, row);
    return error_.empty();
  }
  double* out = row + info_.state_size;
  const char* what = nullptr;
  const auto keep = [&](double value, const char* name) {
    if (!std::isfinite(value)) what = name;
    *out++ = value;
  };
  const Stored kept = stored();
  if (kept.force)
    for (const double f : force(x, row)) keep(f, "force");
  if (kept.energy) keep(energy(x, row), "energy");
  if (kept.shape) {
    shape(row, centres_);
    for (const float c : centres_) keep(c, "shape");
  }
  if (what) error_ = std::string("the ") + what + " is not finite";
  return what == nullptr;
}

}  // namespace hapgrid
