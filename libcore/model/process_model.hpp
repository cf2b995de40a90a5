// A model that is a process: many requests on their way at once, a process that dies or hangs
// replaced by another, and the requests it took with it asked again.
//
// When a process fails, any of the requests that it had may be to blame. Each of them is asked
// again alone, so that one that kills every process cannot take others with it, and gives up after
// kMaxAttempts in all. What is reached does not depend on any of this: an answer belongs to its
// request by its id.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libcore/model/plugin.h"
#include "libcore/model/process.hpp"
#include "libcore/model/protocol.hpp"

namespace hapgrid {

/// How often one request is asked at most.
inline constexpr unsigned kMaxAttempts = 3;

struct ProcessOptions {
  double timeout_seconds = 60;        ///< for one answer
  unsigned in_flight = 4;             ///< requests that one process has at a time
  double start_timeout_seconds = 60;  ///< for the first line, where it is the longer of the two
};

/// One conversion to be asked for: C(s, x, d) into `row`. What is pointed to stays where it is
/// until it is done.
struct Conversion {
  const double* s = nullptr;
  Vec3 x{};
  Vec3 d{};
  double* row = nullptr;
  std::uint64_t tag = 0;  ///< the caller's own
};
/// Gives the next conversion to a process, which is idle or has others at work. False when there is
/// none, or none for one that is not idle: it is asked again after the next answer.
using NextConversion = std::function<bool(Conversion&, bool idle)>;
/// Takes one that is done, in any order; `error` is one line, empty for success.
using ConversionDone = std::function<void(const Conversion&, const std::string& error)>;

/// What all copies of one model process share.
struct ProcessGroup {
  Command command;
  ProcessOptions options;
  std::string handshake;
  Starter starter;
};

class ProcessModel {
 public:
  /// Starts a process, whose first line says what the model is. @throw ModelError
  explicit ProcessModel(std::shared_ptr<ProcessGroup> group);
  /// A further copy; its process starts with its first request and must say `expected`. Without a
  /// group there never is a process: such a model judges equality, as a shard's header tells it.
  ProcessModel(std::shared_ptr<ProcessGroup> group, Description expected);

  const Description& description() const { return description_; }
  /// The functions of plugin.h over this object; those that no process should be asked are NULL.
  const hapgrid_model_table& table() const { return table_; }
  static const ProcessModel& of(const hapgrid_model* model) {
    return *reinterpret_cast<const ProcessModel*>(model);
  }

  /// Asks for all that `next` gives.
  void convert(const NextConversion& next, const ConversionDone& done);
  /// Fills in what is stored with the state at the beginning of `row`, for the HIP at x.
  /// Answers an error in one line, empty for success.
  std::string evaluate(const Vec3& x, double* row);
  std::string known_states(const Vec3& x, std::vector<double>& states);

  /// Closes the process's input: one that is not needed any more ends while others still work.
  void hang_up();

 private:
  using Clock = ChildProcess::Clock;

  struct Request {
    Operation operation = Operation::kConvert;
    Conversion conversion;
    std::vector<double>* states = nullptr;
    std::uint64_t id = 0;
    unsigned attempts = 0;
    Clock::time_point sent;
  };

  void fill_table();
  std::string ask(const Request& request);
  void run(const std::function<bool(Request&, bool)>& next,
           const std::function<void(const Request&, const std::string&)>& done);
  bool send(Request& request, std::string& why);
  std::string start();
  void take_lines(const std::function<void(const Request&, const std::string&)>& done);
  std::string listen(const std::function<void(const Request&, const std::string&)>& done);
  Clock::time_point deadline() const;
  std::string who(const std::string& what) const;

  std::shared_ptr<ProcessGroup> group_;  // declared first: its starter outlives the child
  Description description_;
  bool described_ = false;
  hapgrid_model_table table_{};
  std::unique_ptr<ChildProcess> child_;
  std::uint64_t last_id_ = 0;
  std::vector<Request> flying_;  // ascending by id
  Clock::time_point last_answer_;
  Answer answer_;
  std::string line_;
  std::string dead_;  // why no process can be started any more
};

}  // namespace hapgrid
