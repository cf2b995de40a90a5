// Makes mutants of shards and sessions whose sizes, digests and zstd frames are right (of
// bad/mutants.py): mutants SEED COUNT FOLDER FILE... writes FOLDER/0, FOLDER/1, ...
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t max_size, unsigned seed);

namespace {

std::mt19937 random_bits;  // NOLINT(cert-msc51-cpp): main() seeds it

std::size_t below(std::size_t n) { return n > 0 ? random_bits() % n : 0; }

}  // namespace

/// In place of libFuzzer's: some bytes are changed, taken out, put in or repeated.
extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most) {
  if (size == 0) return 0;
  const std::size_t at = below(size), length = 1 + below(std::min<std::size_t>(size - at, 16));
  switch (below(4)) {
    case 0:
      std::memmove(data + at, data + at + length, size - at - length);
      return std::max<std::size_t>(size - length, 1);
    case 1:
      if (size + length > most) return size;
      std::memmove(data + at + length, data + at, size - at);
      return size + length;
    case 2:
      std::memmove(data + below(size - length + 1), data + at, length);
      return size;
    default:
      for (std::size_t i = 0; i < length; ++i) data[at + i] = static_cast<std::uint8_t>(below(256));
      return size;
  }
}

int main(int argc, char** argv) {
  if (argc < 5) return 2;
  const auto seed = static_cast<unsigned>(std::stoul(argv[1]));
  std::vector<std::string> files;
  for (int i = 4; i < argc; ++i) {
    std::ifstream in(argv[i], std::ios::binary);
    files.emplace_back(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
  }
  for (unsigned n = 0; n < std::stoul(argv[2]); ++n) {
    random_bits.seed(seed + n);
    const std::string& file = files[below(files.size())];
    std::vector<std::uint8_t> bytes(file.begin(), file.end());
    bytes.resize(file.size() + 4096);
    bytes.resize(LLVMFuzzerCustomMutator(bytes.data(), file.size(), bytes.size(), seed + n));
    std::ofstream(std::string(argv[3]) + "/" + std::to_string(n), std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
  }
}
