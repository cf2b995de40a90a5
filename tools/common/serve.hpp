// --serve: a filter that stays, so that a model which takes seconds to load is loaded once.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace hapgrid {

/// The flag --serve, which excludes every option that `app` has by now: they are the lines'.
void add_serve(CLI::App& app, bool& serve);

/// What a line asks for: adds the options of one to the app, and returns what runs it.
using PrepareLine = std::function<std::function<int()>(CLI::App&)>;

/// Takes one command line after the other from standard input, a line each, its words separated by
/// tabs, until the input ends. Behind each, its exit code is a line of standard output; a message
/// goes to standard error, as ever. A last line without an end is not run: its writer was killed.
/// @return the exit code. @throw Error, std::system_error
int serve(const std::string& tool, const PrepareLine& prepare);

/// Of a line's files: standard input and output are the server's. @throw CLI::ValidationError
void require_named(const std::vector<std::string>& inputs, const std::string& output);

/// serve() for a filter's Options, with `shards` and `output` among them.
/// @param unload is called after a failure: who knows in what state it left the model.
template <class Options, class Run, class Unload>
int serve(const std::string& tool, void (*add_options)(CLI::App&, Options&), const Run& run,
          const Unload& unload) {
  return serve(tool, [&](CLI::App& app) -> std::function<int()> {
    const auto options = std::make_shared<Options>();
    add_options(app, *options);
    return [&, options] {
      require_named(options->shards, options->output);
      try {
        return run(*options);
      } catch (...) {
        unload();
        throw;
      }
    };
  });
}

}  // namespace hapgrid
