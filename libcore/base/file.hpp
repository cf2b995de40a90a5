// Files as the filters need them: an output that appears whole or not at all, and an input that
// can be read at any offset even when it comes through a pipe.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <utility>

namespace hapgrid {

/// An open file descriptor that closes itself.
class FileDescriptor {
 public:
  FileDescriptor() = default;
  explicit FileDescriptor(int fd) : fd_(fd) {}
  FileDescriptor(FileDescriptor&& other) noexcept : fd_(other.release()) {}
  FileDescriptor& operator=(FileDescriptor&& other) noexcept;
  ~FileDescriptor();
  int get() const { return fd_; }
  /// The caller closes it.
  int release() { return std::exchange(fd_, -1); }
  explicit operator bool() const { return fd_ >= 0; }

 private:
  int fd_ = -1;
};

/// A file that appears with commit(), whole or not at all: it is written in the same folder as
/// .hapgrid.XXXXXX, synced, and renamed. If commit() is not called, the destructor removes it.
/// After SIGKILL the file .hapgrid.XXXXXX can be left in the folder.
class OutputFile {
 public:
  /// What a tool's -o FILE means: "-" is standard output; a device or a pipe is written directly;
  /// any other file is replaced. Where `name` is a symbolic link, the file that it leads to is
  /// replaced, and the link stays.
  /// @param binary whether a person cannot read it
  /// @throw std::system_error when it cannot be created; Error when a terminal would get binary
  /// output
  explicit OutputFile(const std::string& name, bool binary = true);

  /// Replaces what has this name, also a symbolic link. @throw std::system_error
  static OutputFile replacing(const std::string& name);

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

 private:
  OutputFile(std::string shown_name, FileDescriptor file);

  static OutputFile to_standard_output(bool binary);
  static OutputFile direct(const std::string& name);
  static OutputFile temporary_of(const std::string& target, const std::string& shown_name);
  void set_temporary(std::string name);
  void give_name();

  std::string shown_name_;
  FileDescriptor owned_;
  int fd_ = -1;
  std::string target_;                            // until commit(); empty: written directly
  std::unique_ptr<const std::string> temporary_;  // its name, if it has one before commit()
};

/// A text for people as a whole OutputFile. @throw std::system_error
void write_text(const std::string& name, const std::string& text);

/// Removes the files .hapgrid.XXXXXX of all output files of this process. For the handler of a
/// signal that ends the process.
void remove_unfinished_files() noexcept;

/// What a zstd frame begins with (RFC 8878, 3.1.1).
inline constexpr std::array kZstdMagic{std::byte{0x28}, std::byte{0xB5}, std::byte{0x2F},
                                       std::byte{0xFD}};

/// An input of which any part can be read at any time. A pipe is copied to an unlinked temporary
/// file first (in TMPDIR, else /tmp), because a merge reads several places of its input at once. If
/// the first bytes show that these are no zstd frames, only they are copied: the reader then
/// reports the error.
class InputFile {
 public:
  /// "-" is standard input. @throw std::system_error
  explicit InputFile(const std::string& name);
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

/// @param name for the message. @throw std::system_error; then a part may be written.
void write_all(int fd, std::span<const std::byte> bytes, const std::string& name);

/// The whole of a text file or pipe, or of standard input for "-". No more is read than tells that
/// it is too large. @throw std::system_error; Error when it is larger than `limit` bytes.
std::string read_text(const std::string& name, std::uint64_t limit);

/// The whole of a regular file, also through links, for names that a stranger may have written: a
/// device has no end, and opening a pipe can wait for ever. "-" is a name as any other.
/// @throw as read_text(); Error when it is no regular file.
std::string read_regular_text(const std::string& name, std::uint64_t limit);

/// The folder of this program; empty where the system does not say.
std::filesystem::path own_folder();

}  // namespace hapgrid
