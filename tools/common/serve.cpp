#include "tools/common/serve.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>

#include "libcore/base/error.hpp"
#include "tools/common/progress.hpp"
#include "tools/common/tool.hpp"

namespace hapgrid {

namespace {

std::vector<std::string> words(const std::string& line) {
  std::vector<std::string> words;
  for (std::size_t from = 0; from <= line.size();) {
    const std::size_t to = std::min(line.find('\t', from), line.size());
    words.push_back(line.substr(from, to - from));
    from = to + 1;
  }
  return words;
}

}  // namespace

void add_serve(CLI::App& app, bool& serve) {
  const std::vector<CLI::Option*> of_lines = app.get_options();
  app.add_flag(
      "--serve", serve,
      "Stay: read such command lines from standard input, a line each, words separated by tabs, "
      "and write the exit code of each as a line to standard output. The model is loaded for the "
      "first, and again only for another grid or after a failure. What is said of models here is "
      "for all lines");
  // Not excludes(): the help would name them all again.
  app.final_callback([of_lines, &serve] {
    for (const CLI::Option* option : of_lines)
      if (serve && option->count() > 0)
        throw CLI::ValidationError("--serve",
                                   option->get_name() + " is for the lines that it reads");
  });
}

int serve(const std::string& tool, const PrepareLine& prepare) {
  for (std::string line; std::getline(std::cin, line);) {
    if (std::cin.eof()) throw Error("standard input: the last line has no end, and was not run");
    CLI::App app;
    app.name(tool);
    app.set_help_flag();
    const std::function<int()> run = prepare(app);
    begin_run();
    std::cout << run_line(app, words(line), run) << '\n' << std::flush;
    if (!std::cout) break;  // run_tool() says so
  }
  return kExitDone;
}

void require_named(const std::vector<std::string>& inputs, const std::string& output) {
  if (inputs.empty() || std::count(inputs.begin(), inputs.end(), "-") > 0 || output == "-")
    throw CLI::ValidationError(
        "--serve", "standard input and output are the server's: name the shards and --output");
}

}  // namespace hapgrid
