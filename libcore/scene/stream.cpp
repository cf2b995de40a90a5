#include "libcore/scene/stream.hpp"

#include <capnp/message.h>
#include <capnp/serialize.h>
#include <fcntl.h>
#include <kj/exception.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <system_error>
#include <utility>

#include "frame.capnp.h"
#include "libcore/base/error.hpp"
#include "libcore/grid/box_message.hpp"
#include "libcore/scene/torsion.hpp"

namespace hapgrid {

static_assert(std::endian::native == std::endian::little,
              "the segment table is written as it is in memory, and Cap'n Proto is little-endian");

namespace {

constexpr std::uint64_t kMagic = 0x6861706772696466;  // "hapgridf"
constexpr std::uint32_t kFormatVersion = 1;

constexpr std::size_t kReadBytes = 1 << 16;
constexpr std::uint32_t kMaxSegments = 512;  // as Cap'n Proto's own readers
// A sphere takes 2 words, a pointer, and a label of some words.
constexpr std::uint64_t kSceneLimit = std::uint64_t{64} << 20;
constexpr std::size_t kMaxText = 255;  // bytes of a name, unit or label; a file name has no more

// Upper bounds for the words of a message: pointers and structs of a fixed size, and the lists.
constexpr std::size_t kFixedWords = 64;

std::size_t text_words(const std::string& text) { return text.size() / 8 + 1; }

std::uint64_t frame_words(std::uint64_t state_size, std::uint64_t spheres) {
  return kFixedWords + state_size + (3 * spheres + 1) / 2;
}

void set_vector(scene_schema::Vector::Builder out, const Vec3& v) {
  out.setX(v[0]);
  out.setY(v[1]);
  out.setZ(v[2]);
}

Vec3 get_vector(scene_schema::Vector::Reader in) { return {in.getX(), in.getY(), in.getZ()}; }

std::string get_text(capnp::Text::Reader in, const char* what) {
  if (in.size() > kMaxText)
    throw FormatError(std::string(what) + " of " + std::to_string(in.size()) +
                      " bytes, the limit is " + std::to_string(kMaxText));
  return std::string(in.begin(), in.size());
}

float get_length(float value, const char* what) {
  if (!std::isfinite(value) || value < 0)
    throw FormatError(std::string(what) + " is negative or not finite");
  return value;
}

float get_colour(float value) {
  if (!(value >= 0 && value <= 1)) throw FormatError("a colour is not in [0, 1]");
  return value;
}

void set_torsions(scene_schema::Scene::Builder scene, const std::vector<Torsion>& torsions) {
  auto list = scene.initTorsions(static_cast<unsigned>(torsions.size()));
  for (unsigned i = 0; i < list.size(); ++i) {
    const auto& [spheres, name] = torsions[i];
    list[i].setName(name);
    list[i].setA(spheres[0]);
    list[i].setB(spheres[1]);
    list[i].setC(spheres[2]);
    list[i].setD(spheres[3]);
  }
}

Scene decode_scene(scene_schema::Scene::Reader in) {
  if (in.getMagic() != kMagic) throw FormatError("not a stream of frames");
  if (in.getVersion() != kFormatVersion)
    throw FormatError("format version " + std::to_string(in.getVersion()) +
                      ", this program reads version " + std::to_string(kFormatVersion));
  Scene scene;
  scene.model = get_text(in.getModel(), "a model's name");
  scene.length_unit = get_text(in.getLengthUnit(), "a unit");
  scene.energy_unit = get_text(in.getEnergyUnit(), "a unit");
  scene.keys = get_text(in.getKeys(), "a line about keys");
  scene.box = get_box(in.getBox());
  try {
    scene.box.validate();
  } catch (const Error& e) {
    throw FormatError(e.what());
  }
  scene.state_size = in.getStateSize();
  if (scene.state_size == 0 || scene.state_size > kMaxStateSize)
    throw FormatError("a state of " + std::to_string(scene.state_size) + " components; 1 to " +
                      std::to_string(kMaxStateSize) + " are possible");
  scene.hip_radius = in.getHipRadius();
  if (!std::isfinite(scene.hip_radius) || scene.hip_radius < 0)
    throw FormatError("the radius of the HIP is negative or not finite");
  const auto spheres = in.getSpheres();
  if (spheres.size() > kMaxSpheres)
    throw FormatError("a shape of " + std::to_string(spheres.size()) + " spheres; " +
                      std::to_string(kMaxSpheres) + " are possible");
  scene.spheres.reserve(spheres.size());
  for (const auto sphere : spheres)
    scene.spheres.push_back(
        {get_length(sphere.getRadius(), "a radius"),
         {get_colour(sphere.getRed()), get_colour(sphere.getGreen()), get_colour(sphere.getBlue())},
         get_text(sphere.getLabel(), "a label")});
  if (in.getTorsions().size() > kMaxTorsions)
    throw FormatError(std::to_string(in.getTorsions().size()) + " torsions; " +
                      std::to_string(kMaxTorsions) + " are possible");
  for (const auto torsion : in.getTorsions()) {
    scene.torsions.push_back({{torsion.getA(), torsion.getB(), torsion.getC(), torsion.getD()},
                              get_text(torsion.getName(), "a torsion's name")});
    for (const std::uint32_t sphere : scene.torsions.back().spheres)
      if (sphere >= scene.spheres.size())
        throw FormatError("a torsion of sphere " + std::to_string(sphere) + ", which is not there");
  }
  return scene;
}

template <class List, class To>
void get_list(List in, std::size_t size, const char* what, To& to) {
  if (in.size() != size)
    throw FormatError(std::string(what) + ": " + std::to_string(in.size()) +
                      " values, the scene has " + std::to_string(size));
  std::copy(in.begin(), in.end(), to.begin());
}

void decode_frame(scene_schema::Frame::Reader in, const Scene& scene, Frame& frame) {
  frame.time_s = in.getTime();
  if (!std::isfinite(frame.time_s)) throw FormatError("the time is not finite");
  frame.tick = in.getTick();
  frame.hip = get_vector(in.getHip());
  frame.position = get_vector(in.getPosition());
  frame.force = get_vector(in.getForce());
  frame.raw_force = get_vector(in.getRawForce());
  frame.energy = in.getEnergy();
  frame.row.resize(scene.state_size);
  frame.centres.resize(3 * scene.spheres.size());
  get_list(in.getState(), frame.row.size(), "state", frame.row);
  get_list(in.getLevels(), frame.levels.size(), "levels", frame.levels);
  get_list(in.getCentres(), frame.centres.size(), "centres", frame.centres);
  frame.jumps = in.getJumps();
  frame.own_energy = in.getOwnEnergy();
}

}  // namespace

/// Builds one message with `fill(scene_schema::Message::Builder)`, which needs at most `words`.
template <class F>
std::span<const std::byte> SceneEncoder::build(std::size_t words, F&& fill) {
  // Cap'n Proto wants a segment of zeros, and clears what it used of it when it is done.
  if (segment_.size() < words) segment_.resize(words);
  capnp::MallocMessageBuilder builder(
      kj::arrayPtr(reinterpret_cast<capnp::word*>(segment_.data()), segment_.size()));
  fill(builder.initRoot<scene_schema::Message>());
  const auto segments = builder.getSegmentsForOutput();
  if (segments.size() != 1) throw Error("a message is larger than foreseen");
  const std::size_t used = segments[0].size();
  message_.resize(1 + used);
  message_[0] = std::uint64_t{used} << 32;  // one segment (0: the count less one), its words
  std::memcpy(message_.data() + 1, segments[0].begin(), used * sizeof(capnp::word));
  return std::as_bytes(std::span(message_));
}

std::span<const std::byte> SceneEncoder::encode(const Scene& scene) {
  std::size_t words = kFixedWords + text_words(scene.model) + text_words(scene.length_unit) +
                      text_words(scene.energy_unit) + text_words(scene.keys);
  for (const Sphere& sphere : scene.spheres) words += 3 + text_words(sphere.label);
  for (const Torsion& torsion : scene.torsions) words += 3 + text_words(torsion.name);
  return build(words, [&](scene_schema::Message::Builder message) {
    auto out = message.initScene();
    out.setMagic(kMagic);
    out.setVersion(kFormatVersion);
    out.setModel(scene.model);
    out.setLengthUnit(scene.length_unit);
    out.setEnergyUnit(scene.energy_unit);
    if (!scene.keys.empty()) out.setKeys(scene.keys);
    set_box(out.initBox(), scene.box);
    out.setStateSize(scene.state_size);
    out.setHipRadius(scene.hip_radius);
    auto spheres = out.initSpheres(static_cast<unsigned>(scene.spheres.size()));
    for (unsigned i = 0; i < spheres.size(); ++i) {
      const Sphere& sphere = scene.spheres[i];
      spheres[i].setRadius(sphere.radius);
      spheres[i].setRed(sphere.colour[0]);
      spheres[i].setGreen(sphere.colour[1]);
      spheres[i].setBlue(sphere.colour[2]);
      if (!sphere.label.empty()) spheres[i].setLabel(sphere.label);
    }
    if (!scene.torsions.empty()) set_torsions(out, scene.torsions);
  });
}

std::span<const std::byte> SceneEncoder::encode(const Frame& frame, std::size_t state_size) {
  const std::size_t words = frame_words(state_size, frame.centres.size() / 3);
  return build(words, [&](scene_schema::Message::Builder message) {
    auto out = message.initFrame();
    out.setTime(frame.time_s);
    out.setTick(frame.tick);
    set_vector(out.initHip(), frame.hip);
    set_vector(out.initPosition(), frame.position);
    set_vector(out.initForce(), frame.force);
    set_vector(out.initRawForce(), frame.raw_force);
    out.setEnergy(frame.energy);
    out.setState(kj::arrayPtr(frame.row.data(), state_size));
    out.setLevels(kj::arrayPtr(frame.levels.data(), frame.levels.size()));
    out.setCentres(kj::arrayPtr(frame.centres.data(), frame.centres.size()));
    out.setJumps(frame.jumps);
    out.setOwnEnergy(frame.own_energy);
  });
}

SceneReader::SceneReader(const std::string& name) : name_(name), fd_(STDIN_FILENO) {
  if (name == "-") {
    name_ = "standard input";
  } else {
    owned_ = FileDescriptor(::open(name.c_str(), O_RDONLY | O_CLOEXEC));
    if (!owned_) throw std::system_error(errno, std::generic_category(), name_);
    fd_ = owned_.get();
  }
  take_scene();
}

SceneReader::SceneReader(FileDescriptor file, std::string name)
    : name_(std::move(name)), owned_(std::move(file)), fd_(owned_.get()) {
  take_scene();
}

/// Calls `use(scene_schema::Message::Reader)` on the message; everything that Cap'n Proto throws
/// becomes a FormatError.
template <class F>
void SceneReader::decode(F&& use) const {
  try {
    capnp::ReaderOptions options;
    options.traversalLimitInWords = 2 * words_.size() + 1024;
    options.nestingLimit = 8;
    const auto* begin = reinterpret_cast<const capnp::word*>(words_.data());
    capnp::FlatArrayMessageReader reader(kj::arrayPtr(begin, words_.size()), options);
    use(reader.getRoot<scene_schema::Message>());
  } catch (const FormatError& e) {
    throw FormatError(name_ + ": byte " + std::to_string(message_) + ": " + e.what());
  } catch (const kj::Exception& e) {
    throw FormatError(name_ + ": byte " + std::to_string(message_) +
                      ": damaged: " + std::string(e.getDescription().cStr()));
  }
}

void SceneReader::take_scene() {
  buffer_.resize(kReadBytes);
  if (!take_message(kSceneLimit)) throw FormatError(name_ + ": empty, not a stream of frames");
  decode([&](scene_schema::Message::Reader message) {
    if (!message.isScene()) throw FormatError("not a stream of frames: no scene in front");
    scene_ = decode_scene(message.getScene());
  });
  // Other writers may use some more segments and padding.
  frame_limit_ = 2 * sizeof(std::uint64_t) * frame_words(scene_.state_size, scene_.spheres.size());
}

bool SceneReader::next(Frame& frame) {
  if (!take_message(frame_limit_)) return false;
  decode([&](scene_schema::Message::Reader message) {
    if (message.isScene()) throw FormatError("a second scene");
    if (!message.isFrame())
      throw FormatError("a message of a kind that this version does not know");
    decode_frame(message.getFrame(), scene_, frame);
    if (any_frame_ && frame.tick <= last_tick_)
      throw FormatError("tick " + std::to_string(frame.tick) + " after tick " +
                        std::to_string(last_tick_));
  });
  std::vector<double> angles;
  for (const Torsion& torsion : scene_.torsions) angles.push_back(torsion_degrees(torsion, frame));
  if (!any_frame_) first_angles_ = angles;
  frame.turned.resize(angles.size());
  for (std::size_t i = 0; i < angles.size(); ++i)
    frame.turned[i] = -std::remainder(first_angles_[i] - angles[i], 360);  // 180, never -180
  any_frame_ = true;
  last_tick_ = frame.tick;
  return true;
}

/// Waits for bytes, for the end, or until the wait is given up (give_up_on()).
bool SceneReader::given_up() const {
  if (give_up_ < 0) return false;
  std::array<pollfd, 2> files{{{fd_, POLLIN, 0}, {give_up_, POLLIN, 0}}};
  while (::poll(files.data(), files.size(), -1) < 0)
    if (errno != EINTR) throw std::system_error(errno, std::generic_category(), name_);
  return files[1].revents != 0;
}

/// The next `size` bytes; false when the stream ends in front of the first of them.
bool SceneReader::take(std::byte* to, std::size_t size) {
  std::size_t done = 0;
  while (done < size) {
    if (begin_ == end_) {
      if (given_up()) break;
      const ssize_t count = ::read(fd_, buffer_.data(), buffer_.size());
      if (count < 0 && errno == EINTR) continue;
      if (count < 0) throw std::system_error(errno, std::generic_category(), name_);
      if (count == 0) break;
      begin_ = 0;
      end_ = static_cast<std::size_t>(count);
    }
    const std::size_t part = std::min(size - done, end_ - begin_);
    std::memcpy(to + done, buffer_.data() + begin_, part);
    begin_ += part;
    done += part;
  }
  taken_ += done;
  if (done == 0 && size > 0) return false;
  if (done < size)
    throw FormatError(name_ + ": byte " + std::to_string(message_) +
                      ": truncated: a message is cut");
  return true;
}

bool SceneReader::take_message(std::uint64_t limit) {
  message_ = taken_;
  const auto fail = [&](const std::string& what) {
    throw FormatError(name_ + ": byte " + std::to_string(message_) + ": " + what);
  };
  const auto rest = [&](std::uint64_t* to, std::size_t words) {
    if (!take(reinterpret_cast<std::byte*>(to), words * sizeof *to))
      fail("truncated: a message is cut");
  };
  // The segment table, in halves of words filled up to whole ones: the count less one, then how
  // many words each segment has.
  words_.resize(1);
  if (!take(reinterpret_cast<std::byte*>(words_.data()), sizeof words_[0])) return false;
  const auto more = static_cast<std::uint32_t>(words_[0]);
  if (more >= kMaxSegments) fail("not a stream of frames, or damaged");
  const std::size_t table = (more + 3) / 2;
  words_.resize(table);
  if (table > 1) rest(words_.data() + 1, table - 1);
  std::uint64_t words = table;
  for (std::uint32_t i = 0; i <= more; ++i)
    words += (words_[(i + 1) / 2] >> ((i + 1) % 2 * 32)) & 0xffffffff;
  if (words > limit / sizeof(std::uint64_t))
    fail("a message of " + std::to_string(words * sizeof(std::uint64_t)) + " bytes, the limit is " +
         std::to_string(limit));
  // Memory grows with the bytes that were read, not with the claimed size.
  while (words_.size() < words) {
    const std::size_t old = words_.size();
    words_.resize(std::min<std::size_t>(words, old + kReadBytes));
    rest(words_.data() + old, words_.size() - old);
  }
  return true;
}

}  // namespace hapgrid
