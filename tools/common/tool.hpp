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

/// Gives `app` the name, --version, and the exit codes at the end of its help; `more_exits` are
/// further lines of that table ("  130  ...\n"), `details` stands in front of it.
void describe(CLI::App& app, const std::string& name, const std::string& details = "",
              const std::string& more_exits = "");

/// A number in [low, high], not NaN as with CLI::Range; `description` says so: "a rate from ...".
CLI::Validator number_within(double low, double high, const std::string& description);

/// The option --model-path DIR, repeatable.
void add_model_path(CLI::App& app, std::vector<std::string>& directories);

/// The positional SHARD...
CLI::Option* add_inputs(CLI::App& app, std::vector<std::string>& names, const std::string& help);

/// What add_inputs() collected, with "-" where nothing was named.
/// @throw UsageError when standard input is named twice: it can be read only once.
std::vector<std::string> inputs_or_stdin(std::vector<std::string> names);

/// The option -o, --output FILE, by default "-".
void add_output(CLI::App& app, std::string& name);

/// A name with {} in it, made that of number k. @param option for the message.
/// @throw UsageError without a {}.
void require_mark(const std::string& option, const std::string& pattern);
std::string numbered(std::string pattern, std::uint64_t k);

/// "K/N" with 1 <= K <= N < 2^32, which keeps the arithmetic of cutting inside 64 bits.
/// @throw UsageError
std::pair<std::uint64_t, std::uint64_t> parse_part(const std::string& option,
                                                   const std::string& text);

/// The options of work that can take long: --report FILE (see append_report()), --progress.
void add_report(CLI::App& app, std::string& report);
void add_progress(CLI::App& app, bool& progress);

/// Memory that is freed stays with the process: what one chunk, round or command line needed, the
/// next one needs again, and the system would clear it anew each time.
void keep_memory();

/// Parses the command line and calls `run`, whose result is the exit code; every exception becomes
/// one line "NAME: message" on standard error and an exit code.
int run_tool(CLI::App& app, int argc, char** argv, const std::function<int()>& run);

/// The same for one command line of several that a process gets, in `words`.
int run_line(CLI::App& app, std::vector<std::string> words, const std::function<int()>& run);

}  // namespace hapgrid
