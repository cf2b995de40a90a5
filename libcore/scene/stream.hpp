// The stream of frames (schemas/frame.capnp), written and read.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "libcore/base/error.hpp"
#include "libcore/base/file.hpp"
#include "libcore/base/zstd_frame.hpp"
#include "libcore/scene/scene.hpp"

namespace hapgrid {

/// The stream ends inside a message: play may have been stopped there.
class CutError : public FormatError {
 public:
  using FormatError::FormatError;
};

/// Makes messages. It allocates for the first message of a size, and keeps that memory.
class SceneEncoder {
 public:
  /// The message is valid until the next call.
  std::span<const std::byte> encode(const Scene& scene);
  /// @param state_size how many numbers of the frame's row are its state.
  std::span<const std::byte> encode(const Frame& frame, std::size_t state_size);

 private:
  /// @param words that the message needs at most
  template <class Fill>
  std::span<const std::byte> build(std::size_t words, Fill&& fill);

  MessageWords scratch_;  // see build_message()
  MessageWords message_;
};

/// Reads a stream as it comes: a frame is given out as soon as its last byte is there, so that a
/// live viewer is never behind. The stream is hostile: sizes are checked before memory is taken,
/// and what was read agrees with the scene.
class SceneReader {
 public:
  /// Reads the scene; "-" is standard input.
  /// @throw std::system_error; FormatError "NAME: byte N: ..." when there is none.
  explicit SceneReader(const std::string& name);
  /// A file that is open already, from where it stands.
  SceneReader(FileDescriptor file, std::string name);

  /// The name for messages: "standard input" for "-".
  const std::string& name() const { return name_; }
  const Scene& scene() const { return scene_; }

  /// The next frame; false where the stream ends behind a whole message. Every frame has the
  /// scene's sizes, a finite time, and a tick above the one before.
  /// @throw std::system_error; FormatError "NAME: byte N: ...", the byte where the message starts;
  /// CutError where it is cut.
  bool next(Frame& frame);

  /// From now on a read that waits is given up once `fd` is readable, as if the stream ended there.
  void give_up_on(int fd) { give_up_ = fd; }

 private:
  void read_scene();
  /// Reads the next message into words_; false at the end of the stream. `limit` is in bytes.
  bool read_words(std::uint64_t limit);
  bool read(std::byte* to, std::size_t size);
  bool given_up() const;
  /// Calls use(scene_schema::Message::Reader).
  template <class Use>
  void decode(Use&& use) const;
  [[noreturn]] void fail(const std::string& what) const;
  [[noreturn]] void fail_cut() const;

  std::string name_;
  FileDescriptor owned_;
  int fd_ = -1;
  int give_up_ = -1;
  std::vector<std::byte> buffer_;  // the bytes from begin_ to end_ are still to be used
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
  std::uint64_t bytes_read_ = 0;     // of the stream
  std::uint64_t message_start_ = 0;  // in bytes
  MessageWords words_;               // of the message
  Scene scene_;
  std::uint64_t frame_limit_ = 0;
  bool any_frame_ = false;
  std::uint64_t last_tick_ = 0;
  std::vector<double> first_angles_;  // of the scene's torsions, degrees
};

}  // namespace hapgrid
