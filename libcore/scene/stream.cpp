#include "libcore/scene/stream.hpp"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <system_error>
#include <utility>

#include "frame.capnp.h"
#include "libcore/base/format.hpp"
#include "libcore/base/message.hpp"
#include "libcore/grid/box_message.hpp"
#include "libcore/scene/scene.hpp"

namespace hapgrid {

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

std::uint64_t frame_words(std::uint64_t state_size, std::uint64_t spheres) {
  return kFixedWords + state_size + (3 * spheres + 1) / 2;
}

void set_vector(scene_schema::Vector::Builder out, const Vec3& v) {
  out.setX(v[0]);
  out.setY(v[1]);
  out.setZ(v[2]);
}

Vec3 get_vector(scene_schema::Vector::Reader in) { return {in.getX(), in.getY(), in.getZ()}; }

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
    throw FormatError(format("format version {}, this program reads version {}", in.getVersion(),
                             kFormatVersion));
  Scene scene;
  scene.model = get_text(in.getModel(), kMaxText, "a model's name");
  scene.length_unit = get_text(in.getLengthUnit(), kMaxText, "a unit");
  scene.energy_unit = get_text(in.getEnergyUnit(), kMaxText, "a unit");
  scene.keys = get_text(in.getKeys(), kMaxText, "a line about keys");
  scene.box = get_box(in.getBox());
  scene.state_size = in.getStateSize();
  if (scene.state_size == 0 || scene.state_size > kMaxStateSize)
    throw FormatError(
        format("a state of {} components; 1 to {} are possible", scene.state_size, kMaxStateSize));
  scene.hip_radius = in.getHipRadius();
  scene.largest_force = in.getLargestForce();
  if (!std::isfinite(scene.hip_radius) || scene.hip_radius < 0)
    throw FormatError("the radius of the HIP is negative or not finite");
  const auto spheres = in.getSpheres();
  if (spheres.size() > kMaxSpheres)
    throw FormatError(
        format("a shape of {} spheres; {} are possible", spheres.size(), kMaxSpheres));
  scene.spheres.reserve(spheres.size());
  for (const auto sphere : spheres) scene.spheres.push_back(get_sphere(sphere));
  if (in.getTorsions().size() > kMaxTorsions)
    throw FormatError(
        format("{} torsions; {} are possible", in.getTorsions().size(), kMaxTorsions));
  for (const auto torsion : in.getTorsions()) {
    scene.torsions.push_back({{torsion.getA(), torsion.getB(), torsion.getC(), torsion.getD()},
                              get_text(torsion.getName(), kMaxText, "a torsion's name")});
    for (const std::uint32_t sphere : scene.torsions.back().spheres)
      if (sphere >= scene.spheres.size())
        throw FormatError(format("a torsion of sphere {}, which is not there", sphere));
  }
  return scene;
}

template <class List, class To>
void get_list(List in, std::size_t size, const char* what, To& to) {
  if (in.size() != size)
    throw FormatError(format("{}: {} values, the scene has {}", what, in.size(), size));
  std::copy(in.begin(), in.end(), to.begin());
}

void decode_frame(scene_schema::Frame::Reader in, const Scene& scene, Frame& frame) {
  frame.time_s = in.getTime();
  if (!std::isfinite(frame.time_s)) throw FormatError("the time is not finite");
  frame.tick = in.getTick();
  frame.hip = get_vector(in.getHip());
  frame.hand = in.hasHand() ? get_vector(in.getHand()) : kNowhere;
  frame.position = get_vector(in.getPosition());
  frame.force = get_vector(in.getForce());
  frame.energy = in.getEnergy();
  frame.row.resize(scene.state_size);
  frame.centres.resize(3 * scene.spheres.size());
  get_list(in.getState(), frame.row.size(), "state", frame.row);
  get_list(in.getCentres(), frame.centres.size(), "centres", frame.centres);
  frame.jumps = in.getJumps();
  frame.own_energy = in.getOwnEnergy();
}

}  // namespace

template <class Fill>
std::span<const std::byte> SceneEncoder::build(std::size_t words, Fill&& fill) {
  build_message<scene_schema::Message>(words, scratch_, message_, fill);
  return std::as_bytes(std::span(message_));
}

std::span<const std::byte> SceneEncoder::encode(const Scene& scene) {
  constexpr std::size_t kText = kMaxText / 8 + 1;
  const std::size_t words =
      kFixedWords + 4 * kText + (3 + kText) * (scene.spheres.size() + scene.torsions.size());
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
    out.setLargestForce(scene.largest_force);
    auto spheres = out.initSpheres(static_cast<unsigned>(scene.spheres.size()));
    for (unsigned i = 0; i < spheres.size(); ++i) {
      const Sphere& sphere = scene.spheres[i];
      set_sphere(spheres[i], sphere);
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
    if (finite(frame.hand)) set_vector(out.initHand(), frame.hand);
    set_vector(out.initPosition(), frame.position);
    set_vector(out.initForce(), frame.force);
    out.setEnergy(frame.energy);
    out.setState(kj::arrayPtr(frame.row.data(), state_size));
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
  read_scene();
}

SceneReader::SceneReader(FileDescriptor file, std::string name)
    : name_(std::move(name)), owned_(std::move(file)), fd_(owned_.get()) {
  read_scene();
}

void SceneReader::fail(const std::string& what) const {
  throw FormatError(format("{}: byte {}: {}", name_, message_start_, what));
}

void SceneReader::fail_cut() const {
  throw CutError(format("{}: byte {}: truncated: a message is cut", name_, message_start_));
}

template <class Use>
void SceneReader::decode(Use&& use) const {
  try {
    read_message<scene_schema::Message>(words_, use);
  } catch (const FormatError& e) {
    fail(e.what());
  }
}

void SceneReader::read_scene() {
  buffer_.resize(kReadBytes);
  if (!read_words(kSceneLimit))
    throw FormatError(format("{}: empty, not a stream of frames", name_));
  decode([&](scene_schema::Message::Reader message) {
    if (!message.isScene()) throw FormatError("not a stream of frames: no scene in front");
    scene_ = decode_scene(message.getScene());
  });
  // Other writers may use some more segments and padding.
  frame_limit_ = 2 * sizeof(std::uint64_t) * frame_words(scene_.state_size, scene_.spheres.size());
}

bool SceneReader::next(Frame& frame) {
  if (!read_words(frame_limit_)) return false;
  decode([&](scene_schema::Message::Reader message) {
    if (message.isScene()) throw FormatError("a second scene");
    if (!message.isFrame())
      throw FormatError("a message of a kind that this version does not know");
    decode_frame(message.getFrame(), scene_, frame);
    if (any_frame_ && frame.tick <= last_tick_)
      throw FormatError(format("tick {} after tick {}", frame.tick, last_tick_));
  });
  std::vector<double>& angles = frame.angles;
  angles.clear();
  for (const Torsion& torsion : scene_.torsions)
    angles.push_back(torsion_degrees(torsion, frame.centres));
  if (!any_frame_) first_angles_ = angles;
  frame.turned.resize(angles.size());
  for (std::size_t i = 0; i < angles.size(); ++i)
    frame.turned[i] = turned_degrees(first_angles_[i], angles[i]);
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
bool SceneReader::read(std::byte* to, std::size_t size) {
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
  bytes_read_ += done;
  if (done == 0 && size > 0) return false;
  if (done < size) fail_cut();
  return true;
}

bool SceneReader::read_words(std::uint64_t limit) {
  message_start_ = bytes_read_;
  const auto rest = [&](std::uint64_t* to, std::size_t words) {
    if (!read(reinterpret_cast<std::byte*>(to), words * sizeof *to)) fail_cut();
  };
  // The segment table, in halves of words filled up to whole ones: the count less one, then how
  // many words each segment has.
  words_.resize(1);
  if (!read(reinterpret_cast<std::byte*>(words_.data()), sizeof words_[0])) return false;
  const auto more = static_cast<std::uint32_t>(words_[0]);
  if (more >= kMaxSegments) fail("neither a grid nor a stream of frames, or damaged");
  const std::size_t table = (more + 3) / 2;
  words_.resize(table);
  if (table > 1) rest(words_.data() + 1, table - 1);
  std::uint64_t words = table;
  for (std::uint32_t i = 0; i <= more; ++i)
    words += (words_[(i + 1) / 2] >> ((i + 1) % 2 * 32)) & 0xffffffff;
  if (words > limit / sizeof(std::uint64_t))
    fail(format("a message of {} bytes, the limit is {}", words * sizeof(std::uint64_t), limit));
  // Memory grows with the bytes that were read, not with the claimed size.
  while (words_.size() < words) {
    const std::size_t old = words_.size();
    words_.resize(std::min<std::size_t>(words, old + kReadBytes));
    rest(words_.data() + old, words_.size() - old);
  }
  return true;
}

}  // namespace hapgrid
