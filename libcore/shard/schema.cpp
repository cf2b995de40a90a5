#include "libcore/shard/schema.hpp"

#include <cmath>
#include <type_traits>

#include "libcore/base/error.hpp"

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

schema::Header::Content encode_content(Content content) {
  switch (content) {
    case Content::kGrid:
      return schema::Header::Content::GRID;
    case Content::kFrontier:
      return schema::Header::Content::FRONTIER;
    case Content::kRequests:
      break;
  }
  return schema::Header::Content::REQUESTS;
}

Content decode_content(schema::Header::Content content) {
  switch (content) {
    case schema::Header::Content::GRID:
      return Content::kGrid;
    case schema::Header::Content::FRONTIER:
      return Content::kFrontier;
    case schema::Header::Content::REQUESTS:
      return Content::kRequests;
  }
  throw FormatError("content of a kind that this version does not know");
}

schema::Equality::Norm encode_norm(Equality::Norm norm) {
  switch (norm) {
    case Equality::Norm::kPlugin:
      return schema::Equality::Norm::PLUGIN;
    case Equality::Norm::kMax:
      return schema::Equality::Norm::MAX;
    case Equality::Norm::kRms:
      break;
  }
  return schema::Equality::Norm::RMS;
}

Equality::Norm decode_norm(schema::Equality::Norm norm) {
  switch (norm) {
    case schema::Equality::Norm::PLUGIN:
      return Equality::Norm::kPlugin;
    case schema::Equality::Norm::MAX:
      return Equality::Norm::kMax;
    case schema::Equality::Norm::RMS:
      return Equality::Norm::kRms;
  }
  throw FormatError("a tolerance function of a kind that this version does not know");
}

Coding decode_coding(schema::Header::Reader in, const SectionHeader& header) {
  Coding coding;
  coding.is_coded = in.getVersion() == kCodedVersion;
  if (coding.is_coded != in.hasCoding() || (coding.is_coded && header.content != Content::kGrid))
    throw FormatError("a coding where there can be none, or none where it must be");
  coding.precision = in.getCoding().getPrecision();
  if (!(coding.precision >= 0 && coding.precision <= kMaxPrecision))
    throw FormatError("an impossible precision");
  const auto bounds = in.getCoding().getBounds();
  if (bounds.size() != (coding.is_lossy() ? header.spec.row_size() : 0))
    throw FormatError("bounds of " + std::to_string(bounds.size()) + " columns");
  for (const double bound : bounds) {
    if (!(std::isfinite(bound) && bound >= 0)) throw FormatError("an impossible bound of a column");
    coding.bounds.push_back(bound);
  }
  return coding;
}

}  // namespace

void encode_header(const SectionHeader& header, schema::Header::Builder out) {
  const GridSpec& spec = header.spec;
  out.setMagic(kMagic);
  out.setVersion(header.coding.is_coded ? kCodedVersion : kFormatVersion);
  out.setContent(encode_content(header.content));
  out.setGeneration(header.generation);
  auto box = out.initBox();
  box.setOriginX(spec.box.origin[0]);
  box.setOriginY(spec.box.origin[1]);
  box.setOriginZ(spec.box.origin[2]);
  box.setSpacing(spec.box.spacing);
  box.setCountX(spec.box.counts[0]);
  box.setCountY(spec.box.counts[1]);
  box.setCountZ(spec.box.counts[2]);
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
    const Sphere& sphere = spec.spheres[i];
    spheres[i].setRadius(sphere.radius);
    spheres[i].setRed(sphere.colour[0]);
    spheres[i].setGreen(sphere.colour[1]);
    spheres[i].setBlue(sphere.colour[2]);
    spheres[i].setLabel(sphere.label);
  }
  auto equality = out.initEquality();
  equality.setNorm(encode_norm(spec.equality.norm));
  equality.setWeights(kj::arrayPtr(spec.equality.weights.data(), spec.equality.weights.size()));
  out.setLengthUnit(spec.length_unit);
  out.setEnergyUnit(spec.energy_unit);
  out.setHipRadius(spec.hip_radius);
  if (!header.coding.is_coded) return;
  auto coding = out.initCoding();
  coding.setPrecision(header.coding.precision);
  coding.setBounds(kj::arrayPtr(header.coding.bounds.data(), header.coding.bounds.size()));
}

SectionHeader decode_header(schema::Header::Reader in) {
  if (in.getMagic() != kMagic) throw FormatError("not a hapgrid shard");
  if (in.getVersion() != kFormatVersion && in.getVersion() != kCodedVersion)
    throw FormatError("format version " + std::to_string(in.getVersion()) +
                      ", this program reads versions " + std::to_string(kFormatVersion) + " and " +
                      std::to_string(kCodedVersion));
  SectionHeader header;
  header.content = decode_content(in.getContent());
  header.generation = in.getGeneration();
  GridSpec& spec = header.spec;
  const auto box = in.getBox();
  spec.box.origin = {box.getOriginX(), box.getOriginY(), box.getOriginZ()};
  spec.box.spacing = box.getSpacing();
  spec.box.counts = {box.getCountX(), box.getCountY(), box.getCountZ()};
  try {
    spec.box.validate();
  } catch (const Error& e) {
    throw FormatError(e.what());
  }
  spec.model = in.getModel();
  for (const auto parameter : in.getParameters())
    spec.parameters.push_back(decode_parameter(parameter));
  spec.state_size = in.getStateSize();
  if (spec.state_size == 0 || spec.state_size > kMaxStateSize)
    throw FormatError("a state of " + std::to_string(spec.state_size) + " components; 1 to " +
                      std::to_string(kMaxStateSize) + " are possible");
  spec.tolerance = in.getTolerance();
  spec.tolerance_unit = in.getToleranceUnit();
  if (!std::isfinite(spec.tolerance)) throw FormatError("the tolerance is not finite");
  spec.max_levels = in.getMaxLevels();
  if (spec.max_levels == 0 || spec.max_levels > static_cast<unsigned>(kMaxLevels))
    throw FormatError("a level limit of " + std::to_string(spec.max_levels) + "; 1 to " +
                      std::to_string(kMaxLevels) + " are possible");
  spec.equality.norm = decode_norm(in.getEquality().getNorm());
  for (const double weight : in.getEquality().getWeights()) spec.equality.weights.push_back(weight);
  if (!spec.equality.fits(spec.state_size))
    throw FormatError("impossible weights of the tolerance function");
  spec.length_unit = in.getLengthUnit();
  spec.energy_unit = in.getEnergyUnit();
  spec.hip_radius = in.getHipRadius();
  if (!std::isfinite(spec.hip_radius) || spec.hip_radius < 0)
    throw FormatError("the radius of the HIP is negative or not finite");
  spec.stored = {in.getStored().getForce(), in.getStored().getEnergy(), in.getStored().getShape()};
  const auto spheres = in.getSpheres();
  if (spec.stored.shape != (spheres.size() > 0) || spheres.size() > kMaxSpheres)
    throw FormatError("a shape of " + std::to_string(spheres.size()) + " spheres");
  for (const auto sphere : spheres) {
    spec.spheres.push_back({sphere.getRadius(),
                            {sphere.getRed(), sphere.getGreen(), sphere.getBlue()},
                            sphere.getLabel()});
    const Sphere& s = spec.spheres.back();
    if (!std::isfinite(s.radius) || s.radius < 0 || !std::isfinite(s.colour[0]) ||
        !std::isfinite(s.colour[1]) || !std::isfinite(s.colour[2]) ||
        s.label.size() > kMaxLabelSize)
      throw FormatError("a sphere whose radius, colour or label is impossible");
  }
  header.coding = decode_coding(in, header);
  return header;
}

void encode_footer(const SectionFooter& footer, schema::Footer::Builder out) {
  auto chunks = out.initChunks(static_cast<unsigned>(footer.chunks.size()));
  for (unsigned i = 0; i < chunks.size(); ++i) {
    const ChunkInfo& chunk = footer.chunks[i];
    chunks[i].setRows(chunk.rows);
    chunks[i].setFrontier(chunk.frontier);
    chunks[i].setFirstPoint(chunk.first_point);
    chunks[i].setLastPoint(chunk.last_point);
    chunks[i].setDigestLow(chunk.digest.low);
    chunks[i].setDigestHigh(chunk.digest.high);
    chunks[i].setStored(chunk.stored);
    chunks[i].setConversions(chunk.conversions);
  }
  out.setRecords(footer.records);
  out.setRequests(footer.requests);
  out.setFrontier(footer.frontier);
  out.setConversions(footer.conversions);
  out.setDigestLow(footer.digest.low);
  out.setDigestHigh(footer.digest.high);
}

SectionFooter decode_footer(schema::Footer::Reader in) {
  SectionFooter footer;
  for (const auto chunk : in.getChunks())
    footer.chunks.push_back({chunk.getRows(),
                             chunk.getFrontier(),
                             chunk.getFirstPoint(),
                             chunk.getLastPoint(),
                             {chunk.getDigestLow(), chunk.getDigestHigh()},
                             chunk.getStored(),
                             chunk.getConversions()});
  footer.records = in.getRecords();
  footer.requests = in.getRequests();
  footer.frontier = in.getFrontier();
  footer.conversions = in.getConversions();
  footer.digest = {in.getDigestLow(), in.getDigestHigh()};
  return footer;
}

}  // namespace hapgrid
