// An InputFile under a std::istream, for what reads lines.
#pragma once

#include <array>
#include <streambuf>

#include "libcore/base/file.hpp"

namespace hapgrid {

/// A buffer for std::istream that reads from the file's beginning. The file must outlive it; a
/// failure to read is an exception, of which the stream makes badbit.
class InputBuffer : public std::streambuf {
 public:
  explicit InputBuffer(const InputFile& file) : file_(&file) {}

 private:
  int_type underflow() override {
    const std::size_t count = file_->read(offset_, std::as_writable_bytes(std::span(buffer_)));
    if (count == 0) return traits_type::eof();
    offset_ += count;
    setg(buffer_.data(), buffer_.data(), buffer_.data() + count);
    return traits_type::to_int_type(buffer_[0]);
  }

  const InputFile* file_;
  std::uint64_t offset_ = 0;
  std::array<char, 1 << 16> buffer_;
};

}  // namespace hapgrid
