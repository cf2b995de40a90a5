// What the filters share: help with the table of exit codes, and the one place where failures
// become messages and exit codes.
#pragma once

#include <cstdint>
#include <functional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace CLI {
class App;
class Option;
class Validator;
}  // namespace CLI

namespace hapgrid {

inline constexpr int kExitDone = 0;
inline constexpr int kExitFailed = 1;   ///< input, I/O, model, device, level limit
inline constexpr int kExitUsage = 2;    ///< wrong command line; nothing was read or written
inline constexpr int kExitInvalid = 3;  ///< verify: an invariant is broken

/// The command line is wrong, which shows only when its options are put together.
struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Gives `app` its name, --version, and a --help of at most 100 columns that ends with `details`
/// and the table of exit codes; `more_exits` are further lines of that table ("  130  ...\n").
void set_help(CLI::App& app, const std::string& name, const std::string& details = "",
              const std::string& more_exits = "");

/// A number in [low, high], not NaN as with CLI::Range; `description` says so: "a rate from ...".
CLI::Validator number_within(double low, double high, const std::string& description);

/// The option --model-path DIR, repeatable.
void add_model_path(CLI::App& app, std::vector<std::string>& directories);

/// The positional SHARD...
CLI::Option* add_inputs(CLI::App& app, std::vector<std::string>& names, const std::string& help);

/// The positional GRID, by default "-".
void add_grid(CLI::App& app, std::string& name);

/// What add_inputs() collected, with "-" where nothing was named.
/// @throw UsageError when standard input is named twice: it can be read only once.
std::vector<std::string> inputs_or_stdin(std::vector<std::string> names);

/// The option -o, --output FILE, by default "-".
void add_output(CLI::App& app, std::string& name);

/// "K/N" with 1 <= K <= N < 2^32, which keeps the arithmetic of cutting inside 64 bits.
/// @throw UsageError
std::pair<std::uint64_t, std::uint64_t> parse_part(const std::string& option,
                                                   const std::string& text);

/// The options of work that can take long: --cost FILE (see append_cost()), --progress.
void add_cost(CLI::App& app, std::string& file);
void add_progress(CLI::App& app, bool& progress);

/// Memory that is freed stays with the process: what one chunk, round or command line needed, the
/// next one needs again, and the system would clear it anew each time.
void keep_memory();

/// Parses the command line and calls `run`, whose result is the exit code; every exception becomes
/// one line "NAME: message" on standard error and an exit code.
int run_tool(CLI::App& app, int argc, char** argv, const std::function<int()>& run);

}  // namespace hapgrid
