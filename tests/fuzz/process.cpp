// The lines of a model process: its description, then answers to requests. The first line is taken
// for a description, and the others as its answers; or all of them are a fixed model's answers.
#include <algorithm>

#include "libcore/model/protocol.hpp"
#include "tests/fuzz/fuzz.hpp"

using namespace hapgrid;

namespace {

void take(std::string_view line, const Description& description) {
  Answer answer;
  read_answer(line, answer);
  std::vector<double> row(description.row_size());
  for (const Operation operation : {Operation::kConvert, Operation::kEvaluate})
    fuzz::refusable([&] { take_row(answer, description, operation, row.data()); });
  fuzz::refusable([&] {
    if (take_states(answer, description).size() % description.state_size != 0)
      throw std::logic_error("half a state");
  });
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Description description;
  description.state_size = 2;
  description.stored = {true, true, true};
  description.spheres.resize(1);
  bool first = true;
  for (std::string_view rest = fuzz::text_of({data, size}); !rest.empty();) {
    const std::string_view line = rest.substr(0, rest.find('\n'));
    rest.remove_prefix(std::min(rest.size(), line.size() + 1));
    if (first) fuzz::refusable([&] { description = read_description(line); });
    first = false;
    fuzz::refusable([&] { take(line, description); });
  }
  return 0;
}
