// What the filters share: options that several have, and the one place where failures become
// messages and exit codes.
#pragma once

#include <functional>
#include <string>

#include "tools/common/command_line.hpp"

namespace hapgrid {

inline constexpr int kExitDone = 0;
inline constexpr int kExitFailed = 1;  ///< input, I/O, model, device, level limit
inline constexpr int kExitUsage = 2;   ///< wrong command line; nothing was read or written
inline constexpr int kExitInvalid =
    3;  ///< verify, check-model: the grid or the model breaks a rule
inline constexpr int kExitNotProved = 4;  ///< verify: nothing is broken, but not all is proved

/// The positional GRID, by default "-".
void add_grid(CommandLine& app, std::string& name);

/// The option -o, --output FILE, by default "-".
void add_output(CommandLine& app, std::string& name);

/// The option of work that can take long: --cost FILE (see append_cost()).
void add_cost(CommandLine& app, std::string& file);

/// Writes the line "TOOL: TEXT" to standard error; `text` may have anything in it.
void say(const std::string& tool, const std::string& text);
/// Where standard error is a pipe that is full and stays so for 2 s, messages are thrown away from
/// here on, so that the end of a program does not wait for whoever reads no more.
void give_up_unread_messages();

/// Says in a line that this program reads a terminal, where `input` is "-" and standard input is
/// one: who forgot a file's name would wait without knowing for what.
void announce_terminal(const std::string& input);

/// Memory that is freed stays with the process: what one chunk, round or command line needed, the
/// next one needs again, and the system would clear it anew each time.
void keep_memory();

/// Parses the command line and calls `run`, whose result is the exit code. Every exception becomes
/// one line "NAME: message" on standard error and an exit code. A signal that ends the process
/// removes its unfinished files.
int run_tool(CommandLine& app, int argc, char** argv, const std::function<int()>& run);

}  // namespace hapgrid
