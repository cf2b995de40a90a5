#include "libcore/shard/schema.hpp"

#include <cmath>
#include <type_traits>

#include "libcore/base/error.hpp"
#include "libcore/grid/box_message.hpp"

namespace hapgrid {

namespace {

template <class List>
void set_texts(List list, const std::vector<std::string>& texts) {
  for (unsigned i = 0; i < texts.size(); ++i) list.set(i, texts[i]);
}

void encode_parameter(const Parameter& parameter, schema::Parameter::Builder out) {
  out.setKey(parameter.key);
  auto value = out.getValue();
  std::visit(
      [&](const auto& v) {
        using T = std::decay_t<decltype(v)>;
        if constexpr (std::is_same_v<T, bool>) {
          value.setBoolean(v);
        } else if constexpr (std::is_same_v<T, double>) {
          value.setNumber(v);
        } else if constexpr (std::is_same_v<T, std::string>) {
          value.setText(v);
        } else if constexpr (std::is_same_v<T, std::vector<double>>) {
          value.setNumbers(kj::arrayPtr(v.data(), v.size()));
        } else {
          set_texts(value.initTexts(static_cast<unsigned>(v.size())), v);
        }
      },
      parameter.value);
}

Parameter decode_parameter(schema::Parameter::Reader in) {
  Parameter parameter{in.getKey(), false};
  const auto value = in.getValue();
  switch (value.which()) {
    case schema::Parameter::Value::BOOLEAN:
      parameter.value = value.getBoolean();
      break;
    case schema::Parameter::Value::NUMBER:
      parameter.value = value.getNumber();
      break;
    case schema::Parameter::Value::TEXT:
      parameter.value = std::string(value.getText());
      break;
    case schema::Parameter::Value::NUMBERS: {
      std::vector<double> numbers;
      for (const double number : value.getNumbers()) numbers.push_back(number);
      parameter.value = std::move(numbers);
      break;
    }
    case schema::Parameter::Value::TEXTS: {
      std::vector<std::string> texts;
      for (const auto text : value.getTexts()) texts.emplace_back(text);
      parameter.value = std::move(texts);
      break;
    }
    default:
      throw FormatError("a parameter of a kind that this version does not know");
  }
  return parameter;
}

/// The enumerators of both have the same numbers. @throw FormatError where there is no such one
template <class To, class From>
To known(From from, To last, const char* what) {
  if (static_cast<unsigned>(from) > static_cast<unsigned>(last))
    throw FormatError(format("{} of a kind that this version does not know", what));
  return static_cast<To>(from);
}
static_assert(
    static_cast<int>(schema::Header::Content::REQUESTS) == static_cast<int>(Content::kRequests) &&
    static_cast<int>(schema::Equality::Norm::MAX) == static_cast<int>(Equality::Norm::kMax) &&
    static_cast<int>(schema::Equality::Norm::RMS) == static_cast<int>(Equality::Norm::kRms));

/// The numbers of a header that have limits.
void decode_limits(schema::Header::Reader in, GridSpec& spec) {
  spec.state_size = in.getStateSize();
  if (spec.state_size == 0 || spec.state_size > kMaxStateSize)
    throw FormatError(
        format("a state of {} components; 1 to {} are possible", spec.state_size, kMaxStateSize));
  spec.tolerance = in.getTolerance();
  if (!std::isfinite(spec.tolerance)) throw FormatError("the tolerance is not finite");
  spec.max_levels = in.getMaxLevels();
  if (spec.max_levels == 0 || spec.max_levels > static_cast<unsigned>(kMaxLevels))
    throw FormatError(
        format("a level limit of {}; 1 to {} are possible", spec.max_levels, kMaxLevels));
  spec.equality.norm =
      known(in.getEquality().getNorm(), Equality::Norm::kRms, "a tolerance function");
  for (const double weight : in.getEquality().getWeights()) spec.equality.weights.push_back(weight);
  for (const double period : in.getEquality().getPeriods()) spec.equality.periods.push_back(period);
  if (!spec.equality.fits_periods(spec.state_size))
    throw FormatError("impossible periods of the state's components");
  if (!spec.equality.fits(spec.state_size))
    throw FormatError("impossible weights of the tolerance function");
  spec.hip_radius = in.getHipRadius();
  if (!std::isfinite(spec.hip_radius) || spec.hip_radius < 0)
    throw FormatError("the radius of the HIP is negative or not finite");
  spec.force_scale = in.getForceScale();
  if (!std::isfinite(spec.force_scale) || spec.force_scale < 0)
    throw FormatError("the scale of the force is negative or not finite");
}

}  // namespace

void encode_header(const SectionHeader& header, schema::Header::Builder out) {
  const GridSpec& spec = header.spec;
  out.setMagic(kMagic);
  out.setVersion(kFormatVersion);
  out.setContent(static_cast<schema::Header::Content>(header.content));
  out.setGeneration(header.generation);
  set_box(out.initBox(), spec.box);
  out.setModel(spec.model);
  auto parameters = out.initParameters(static_cast<unsigned>(spec.parameters.size()));
  for (unsigned i = 0; i < parameters.size(); ++i)
    encode_parameter(spec.parameters[i], parameters[i]);
  out.setStateSize(spec.state_size);
  out.setTolerance(spec.tolerance);
  out.setToleranceUnit(spec.tolerance_unit);
  out.setMaxLevels(spec.max_levels);
  // In the order of the ordinals, so that a header is the same bytes as when capnp encodes it.
  auto stored = out.initStored();
  stored.setForce(spec.stored.force);
  stored.setEnergy(spec.stored.energy);
  stored.setShape(spec.stored.shape);
  auto spheres = out.initSpheres(static_cast<unsigned>(spec.spheres.size()));
  for (unsigned i = 0; i < spheres.size(); ++i) {
    set_sphere(spheres[i], spec.spheres[i]);
    spheres[i].setLabel(spec.spheres[i].label);
  }
  auto equality = out.initEquality();
  equality.setNorm(static_cast<schema::Equality::Norm>(spec.equality.norm));
  equality.setWeights(kj::arrayPtr(spec.equality.weights.data(), spec.equality.weights.size()));
  equality.setPeriods(kj::arrayPtr(spec.equality.periods.data(), spec.equality.periods.size()));
  out.setLengthUnit(spec.length_unit);
  out.setEnergyUnit(spec.energy_unit);
  out.setHipRadius(spec.hip_radius);
  out.setForceScale(spec.force_scale);
  if (!spec.version.empty()) out.setModelVersion(spec.version);
}

SectionHeader decode_header(schema::Header::Reader in) {
  if (in.getMagic() != kMagic) throw FormatError("not a hapgrid shard");
  if (in.getVersion() != kFormatVersion)
    throw FormatError(format("format version {}, this program reads version {}", in.getVersion(),
                             kFormatVersion));
  SectionHeader header;
  header.content = known(in.getContent(), Content::kRequests, "content");
  header.generation = in.getGeneration();
  GridSpec& spec = header.spec;
  spec.box = get_box(in.getBox());
  spec.model = in.getModel();
  for (const auto parameter : in.getParameters())
    spec.parameters.push_back(decode_parameter(parameter));
  decode_limits(in, spec);
  spec.tolerance_unit = in.getToleranceUnit();
  spec.length_unit = in.getLengthUnit();
  spec.energy_unit = in.getEnergyUnit();
  spec.version = in.getModelVersion();
  spec.stored = {in.getStored().getForce(), in.getStored().getEnergy(), in.getStored().getShape()};
  const auto spheres = in.getSpheres();
  if (spec.stored.shape != (spheres.size() > 0) || spheres.size() > kMaxSpheres)
    throw FormatError(format("a shape of {} spheres", spheres.size()));
  for (const auto sphere : spheres) spec.spheres.push_back(get_sphere(sphere));
  return header;
}

void encode_footer(const Section& section, schema::Footer::Builder out) {
  out.setHeaderSize(section.header_size);
  auto chunks = out.initChunks(static_cast<unsigned>(section.chunks.size()));
  for (unsigned i = 0; i < chunks.size(); ++i) {
    const ChunkInfo& chunk = section.chunks[i];
    chunks[i].setSize(chunk.size);
    chunks[i].setRows(chunk.rows);
    chunks[i].setFrontier(chunk.frontier);
    chunks[i].setConversions(chunk.conversions);
    chunks[i].setFirstPoint(chunk.first_point);
    chunks[i].setLastPoint(chunk.last_point);
    chunks[i].setDigestLow(chunk.digest.low);
    chunks[i].setDigestHigh(chunk.digest.high);
  }
  out.setDigestLow(section.digest.low);
  out.setDigestHigh(section.digest.high);
}

void decode_footer(schema::Footer::Reader in, Section& section) {
  section.header_size = in.getHeaderSize();
  for (const auto chunk : in.getChunks()) {
    ChunkInfo& info = section.chunks.emplace_back();
    info.size = chunk.getSize();
    info.rows = chunk.getRows();
    info.frontier = chunk.getFrontier();
    info.conversions = chunk.getConversions();
    info.first_point = chunk.getFirstPoint();
    info.last_point = chunk.getLastPoint();
    info.digest = {chunk.getDigestLow(), chunk.getDigestHigh()};
  }
  section.digest = {in.getDigestLow(), in.getDigestHigh()};
}

}  // namespace hapgrid
