// Runs a fuzz target over every file of some directories, for the plain tests: without a fuzzer, in
// any build. A finding ends it as it would end the fuzzer, by a signal or a sanitizer's report.
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <vector>

#include "libcore/base/file.hpp"
#include "tests/fuzz/fuzz.hpp"

// Targets with a mutator of their own refer to libFuzzer's, which is only there with libFuzzer.
extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t*, std::size_t size, std::size_t) {
  return size;
}

int main(int argc, char** argv) {
  std::size_t inputs = 0;
  for (int i = 1; i < argc; ++i) {
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(argv[i]))
      files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    for (const std::filesystem::path& file : files) {
      std::cout << file.string() << std::endl;  // flushed: the last line is the one that failed
      const std::string text = hapgrid::read_text(file, 1 << 24);
      LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
      ++inputs;
    }
  }
  if (inputs == 0) {
    std::cerr << "run_corpus: no inputs" << std::endl;
    return 1;
  }
  return 0;
}
