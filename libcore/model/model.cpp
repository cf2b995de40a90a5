#include "libcore/model/model.hpp"

#include <algorithm>
#include <cassert>
#include <cctype>
#include <cmath>
#include <limits>

#include "libcore/base/child.hpp"
#include "libcore/base/error.hpp"
#include "libcore/base/format.hpp"

namespace hapgrid {

bool is_valid_name(const std::string& name) {
  if (name.empty() || name.size() > 100 || name[0] == '-') return false;
  for (const char c : name)
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '-' && c != '_') return false;
  return true;
}

void require_possible_shape(std::size_t spheres) {
  if (spheres > kMaxSpheres)
    throw ModelError(format("a shape of {} spheres; {} are possible", spheres, kMaxSpheres));
}

void ModelInfo::validate() const {
  if (state_size == 0 || state_size > kMaxStateSize)
    throw ModelError(
        format("a state of {} components; 1 to {} are possible", state_size, kMaxStateSize));
  if (!(d_max > 0)) throw ModelError("d_max is not positive");
  if (!std::isfinite(tolerance) || tolerance < 0)
    throw ModelError("the tolerance is negative or not finite");
  if (!std::isfinite(hip_radius) || hip_radius < 0)
    throw ModelError("the radius of the HIP is negative or not finite");
  if (!std::isfinite(force_scale) || force_scale < 0)
    throw ModelError("the scale of the force is negative or not finite");
  require_possible_shape(spheres.size());
  for (const Sphere& sphere : spheres)
    if (!std::isfinite(sphere.radius) || sphere.radius < 0)
      throw ModelError("a sphere whose radius is negative or not finite");
}

namespace {
constexpr char kNotStarted[] = "this model's process was not started";
}  // namespace

std::vector<double> Model::known_states(const Vec3&) {
  throw ModelError(format("known states: {}", kNotStarted));
}

bool Model::convert(const double*, const Vec3&, const Vec3&, double*) {
  error_ = kNotStarted;
  return false;
}

bool Model::complete(const Vec3&, double* row) { return convert(row, {}, {}, row); }

bool Model::equal(const double* a, const double* b) const {
  return are_equal(info_.equality, info_.tolerance, info_.state_size, a, b);
}

void Model::convert_all(const NextConversion& next, const ConversionDone& done) {
  for (Conversion c; next(c, true);)
    done(c, convert(c.s, c.x, c.d, c.row) ? std::string_view() : error_);
}

std::uint64_t Model::memory_bytes() const { return memory_of_this_process(); }

Vec3 Model::force(const Vec3&, const double*) const {
  assert(!"this model has no force");
  return {0, 0, 0};
}

double Model::energy(const Vec3&, const double*) const {
  assert(!"this model has no energy");
  return 0;
}

double Model::own_energy(const double*) const {
  assert(!"this model has no energy of its own");
  return 0;
}

void Model::shape(const Vec3&, const double*, std::span<float>) const {
  assert(!"this model has no shape");
}

std::vector<std::unique_ptr<Model>> make_models(const MakeModel& make_model, int threads) {
  std::vector<std::unique_ptr<Model>> models;
  do {
    models.push_back(make_model());
    if (const std::uint32_t most = models.front()->info().processes; most > 0)
      threads = std::min(threads, static_cast<int>(std::min(most, kMaxInFlight)));
  } while (models.size() < static_cast<std::size_t>(threads));
  return models;
}

std::unique_ptr<Model> declared_model(const GridSpec& spec) {
  ModelInfo info{spec, /*d_max=*/std::numeric_limits<double>::infinity(), 0, 0, {}};
  return std::make_unique<Model>(std::move(info));
}

}  // namespace hapgrid
