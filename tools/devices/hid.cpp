// hapgrid-hid: an adapter to a HID device that a text file describes, the profile.
//
// | what                                 | outcome                                               |
// |--------------------------------------|-------------------------------------------------------|
// | no report for stall_ms               | the state says so, with the last position             |
// | cut reports, reports of other kinds  | ignored; if no others come, the device is silent      |
// | the first input does not come        | stop reports; it ends                                 |
// | a read or write fails (unplugged)    | zero force and stop reports are tried; it ends        |
// | no force for watchdog_ms             | zero force                                            |
// | a write takes longer than 0.1 s      | play ends it; the kernel waits up to 5 s for a device |
// |                                      | that takes no report, and then nothing could reach it |
#include <chrono>
#include <filesystem>
#include <system_error>
#include <thread>
#include <utility>

#include "libcore/base/error.hpp"
#include "libcore/base/file.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/text.hpp"
#include "tools/devices/adapter.hpp"
#include "tools/devices/profile.hpp"
#include "tools/devices/spacemouse_reports.hpp"

using namespace hapgrid;
using namespace std::chrono_literals;
namespace fs = std::filesystem;

namespace {

constexpr auto kFirstInput = 2s;
constexpr std::uint64_t kMaxProfileBytes = 1 << 20;

Hardware::Clock::duration to_duration(double seconds) {
  return std::chrono::duration_cast<Hardware::Clock::duration>(
      std::chrono::duration<double>(seconds));
}

class ProfiledDevice : public Hardware {
 public:
  /// Opens the device, starts it, and waits for its first report, so that no position is made up. A
  /// device that may have been started is stopped before a failure is told.
  ProfiledDevice(Profile profile, const std::string& path, double rate)
      : profile_(std::move(profile)), path_(path), handle_(path), rate_(rate) {
    try {
      start();
    } catch (const std::exception&) {
      try {
        write_all(handle_, profile_.stop_reports());
      } catch (const std::exception&) {  // the first failure is the one to be told
      }
      throw;
    }
  }

  hapgrid_device_greeting greeting() const override {
    return made_greeting(profile_.name, profile_.low, profile_.high,
                         profile_.outputs.empty() ? 0 : profile_.max_force, rate_,
                         HAPGRID_DEVICE_RELEASES);
  }

  Clock::duration patience() const override {
    return std::min(Hardware::patience(), to_duration(profile_.timing.watchdog));
  }

  void measure(hapgrid_device_state& state) override {
    drain();
    state = newest_;
    if (Clock::now() - heard_ > to_duration(profile_.timing.stall))
      state.flags |= HAPGRID_DEVICE_STALLED;
  }

  void apply(const Vec3& force) override {
    force_ = force;
    write_all(handle_, profile_.encode(force));
    if (profile_.keep_alive.empty()) said_ = Clock::now();
  }

  Clock::time_point due() const override {
    const double period = profile_.timing.keep_alive;
    return period > 0 ? said_ + to_duration(period) : Clock::time_point::max();
  }

  void work() override {
    said_ = Clock::now();
    write_all(handle_, profile_.keep_alive.empty() ? profile_.encode(force_) : profile_.keep_alive);
  }

  void let_go() override { write_all(handle_, profile_.stop_reports()); }

 private:
  void start() {
    for (const Profile::Literal& literal : profile_.init)
      literal.is_feature ? handle_.set_feature(literal.report) : handle_.write(literal.report);
    drain();  // what the kernel has kept may be old
    heard_ = {};
    for (const auto end = Clock::now() + kFirstInput; heard_ == Clock::time_point();) {
      if (Clock::now() > end) throw DeviceError(path_ + ": " + no_input());
      if (is_told_to_end()) throw Error("ended by a signal before the device's first input");
      std::this_thread::sleep_for(1ms);
      drain();
    }
  }

  void drain() {
    handle_.drain([&](std::span<const std::uint8_t> report) {
      // hidapi leaves out the id of a device that has none.
      HidReport whole(report.begin(), report.end());
      if (profile_.input_id == 0) whole.insert(whole.begin(), 0);
      if (profile_.decode(whole, newest_))
        heard_ = Clock::now();
      else if (odd_++ == 0)
        odd_report_ = format("report {} of {} bytes", whole[0], report.size());
    });
  }

  std::string no_input() const {
    return format("no input within {} s: {}", kFirstInput / 1s,
                  odd_ == 0 ? std::string("the device sent no report")
                            : format("{} reports that are not its input, the first one was {}",
                                     odd_, odd_report_));
  }

  Profile profile_;
  std::string path_;
  HidHandle handle_;
  double rate_;
  hapgrid_device_state newest_{};
  Vec3 force_{0, 0, 0};
  Clock::time_point heard_;                // the last input
  Clock::time_point said_ = Clock::now();  // the last keep-alive
  std::uint64_t odd_ = 0;                  // reports that are no input
  std::string odd_report_;
};

Profile read_file(const AdapterWords& words) {
  if (words.words.size() != 1) throw Error("one argument is needed: the file with the profile");
  const std::string& file = words.words[0];
  return read_profile(read_regular_text(file, kMaxProfileBytes), file);
}

std::string find(const Profile& profile) {
  return find_one_hid(list_hid(), profile.match,
                      format("[match] serial or path in {}", profile.file))
      .path;
}

std::unique_ptr<Hardware> open(const AdapterWords& words) {
  Profile profile = read_file(words);
  const std::string path = find(profile);
  return std::make_unique<ProfiledDevice>(std::move(profile), path, words.rate);
}

void release(const AdapterWords& words) {
  const Profile profile = read_file(words);
  HidHandle handle(find(profile));
  write_all(handle, profile.stop_reports());
}

/// The profiles that are installed beside the adapters.
std::vector<Profile> known_profiles() {
  std::vector<Profile> profiles;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(own_folder() / "../devices", none)) {
    if (entry.path().extension() != ".toml") continue;
    try {
      const std::string file = fs::canonical(entry.path()).string();
      profiles.push_back(read_profile(read_regular_text(file, kMaxProfileBytes), file));
    } catch (const std::exception&) {  // it is not ours to complain here
    }
  }
  return profiles;
}

/// Mice and keyboards are HID devices, too, and the spacemouse adapter lists its own.
bool is_no_handle(const HidInfo& info) {
  const bool desktop = info.usage_page == 1 && (info.usage == 2 || info.usage == 6 ||
                                                info.usage == 7 || info.usage == 0x80);
  return desktop || info.usage_page == 0x0c || is_spacemouse(info.vid, info.pid);
}

std::vector<ListedDevice> list() {
  const std::vector<Profile> profiles = known_profiles();
  std::vector<ListedDevice> listed;
  for (const HidInfo& info : list_hid()) {
    if (is_no_handle(info)) continue;
    ListedDevice device{"hid:PROFILE", "?",
                        format("{}, interface {}, usage {}:{}, {}", shown_name(info),
                               info.interface, hex4(info.usage_page), hex4(info.usage), info.path)};
    if (!info.serial.empty()) device.name += ", serial " + info.serial;
    for (const Profile& profile : profiles)
      if (profile.match.fits(info)) {
        device.device = "hid:" + profile.file;
        device.feels = profile.outputs.empty() ? "-" : "force";
      }
    if (!may_open(info.path)) device.forbidden = permission_help(info.vid, info.pid);
    listed.push_back(std::move(device));
  }
  return listed;
}

}  // namespace

int main(int argc, char** argv) {
  return adapter_main(argc, argv, {"PROFILE", open, release, list});
}
