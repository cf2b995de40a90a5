// Files as the filters need them: an output that appears whole or not at all, and an input that
// can be read at any offset even when it comes through a pipe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

namespace hapgrid {

/// An open file descriptor that closes itself.
class FileDescriptor {
 public:
  FileDescriptor() = default;
  explicit FileDescriptor(int fd) : fd_(fd) {}
  FileDescriptor(FileDescriptor&& other) noexcept : fd_(other.fd_) { other.fd_ = -1; }
  FileDescriptor& operator=(FileDescriptor&& other) noexcept;
  ~FileDescriptor();
  int get() const { return fd_; }
  explicit operator bool() const { return fd_ >= 0; }

 private:
  int fd_ = -1;
};

/// A file that is written beside its final name, synced, and renamed by commit(); without commit()
/// nothing is left of it. After SIGKILL neither, where the file system has O_TMPFILE, unless it
/// came when a file was just being replaced: the new one is left beside it, as .NAME.PID.
/// "-" is standard output; a device or pipe is written directly.
class OutputFile {
 public:
  /// What becomes of a file that is never committed.
  enum class Unfinished {
    kVanishes,
    kStays,  ///< as NAME.part, where it is written all the time: for what cannot be made again
  };

  /// What becomes of a symbolic link of that name.
  enum class Links {
    kFollowed,  ///< the file that it names is written
    kReplaced,  ///< as is anything else that is no directory
  };

  /// @throw std::system_error when it cannot be created; Error when "-" is a terminal and `binary`,
  /// or when a NAME.part is there already.
  explicit OutputFile(std::string name, bool binary = true,
                      Unfinished unfinished = Unfinished::kVanishes,
                      Links links = Links::kFollowed);
  OutputFile(OutputFile&&) = default;
  OutputFile& operator=(OutputFile&&) = delete;
  ~OutputFile();

  /// The name for messages: "standard output" for "-".
  const std::string& name() const { return shown_name_; }
  int fd() const { return fd_; }

  /// @throw std::system_error
  void write(std::span<const std::byte> bytes);
  void write(const std::string& text) { write(std::as_bytes(std::span(text))); }
  /// Makes the file appear. @throw std::system_error
  void commit();
  /// Where it is until commit(): NAME.part; empty where nothing would stay.
  std::string part() const { return stays_ ? temporary_ : std::string(); }
  /// Without commit() nothing is to stay after all.
  void discard() { stays_ = false; }

 private:
  /// Gives an O_TMPFILE a name. False when there is a file of that name.
  /// @throw std::system_error
  bool link_to(const std::string& name);

  std::string target_;     // empty: written directly
  std::string temporary_;  // named temporary file: to stay, or where O_TMPFILE is missing
  bool stays_ = false;
  std::string shown_name_;
  FileDescriptor owned_;
  int fd_ = -1;
};

/// An input of which any part can be read at any time. A pipe is copied to an unlinked temporary
/// file first (in TMPDIR, else /tmp): a merge needs several places of its input at once. Where what
/// comes through it is not what it has to be, no more than that is copied, so that its reader
/// refuses it as it refuses a file; and a copy never fills the disk.
class InputFile {
 public:
  /// What comes through a pipe.
  enum class Content {
    kFrames,        ///< zstd frames
    kFramesOrText,  ///< these, or text, without a byte that is 0
  };
  /// "-" is standard input. @throw std::system_error; Error when a pipe has more than the disk
  explicit InputFile(std::string name, Content content = Content::kFrames);
  /// A regular file that is open already, from its start.
  InputFile(FileDescriptor file, std::string name);

  /// The name for messages: "standard input" for "-".
  const std::string& name() const { return shown_name_; }
  std::uint64_t size() const { return size_; }
  /// Reads at most bytes.size() bytes at `offset`; fewer only at the end.
  /// @throw std::system_error
  std::size_t read(std::uint64_t offset, std::span<std::byte> bytes) const;

 private:
  std::string shown_name_;
  FileDescriptor owned_;
  int fd_ = -1;
  std::uint64_t start_ = 0;
  std::uint64_t size_ = 0;
};

/// An unlinked file in `directory`, gone when it is closed. @throw std::system_error
FileDescriptor unlinked_file(const std::filesystem::path& directory);

/// @param name for the message. @throw std::system_error; then a part may be written.
void write_all(int fd, std::span<const std::byte> bytes, const std::string& name);

/// The whole of a text file or pipe, or of standard input for "-". No more is read than tells that
/// it is too large. @throw std::system_error; Error when it is larger than `limit` bytes.
std::string read_text(const std::string& name, std::uint64_t limit);

/// The whole of a regular file, also through links, for names that a stranger may have written: a
/// device has no end, and opening a pipe can wait for ever. "-" is a name as any other.
/// @throw as read_text(); Error when it is no regular file.
std::string read_regular_text(const std::string& name, std::uint64_t limit);

}  // namespace hapgrid
