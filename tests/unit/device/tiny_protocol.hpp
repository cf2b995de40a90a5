// The smallest protocol: an input report of two bytes, 0xA5 and a position in mm, and an output
// report 0xF0 with the force in N; no ids.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "libcore/device/hid_protocol.hpp"

class TinyProtocol : public hapgrid::HidProtocol {
 public:
  explicit TinyProtocol(hapgrid::HidTiming timing = {}, std::vector<hapgrid::HidReport> alive = {})
      : timing_(timing), alive_(std::move(alive)) {}

  static hapgrid::HidReport force(int newtons) {
    return {0, 0xF0, static_cast<std::uint8_t>(newtons)};
  }
  static hapgrid::HidReport started() { return {0, 0x11}; }
  static hapgrid::HidReport stopped() { return {0, 0x5E}; }
  static hapgrid::HidReport snapped() { return {0, 0x5A}; }

  hapgrid::DeviceInfo info() const override {
    return {.name = "tiny",
            .unit = hapgrid::DeviceInfo::Unit::kMetres,
            .high = {0.255, 0, 0},
            .max_force = 200};
  }
  hapgrid::HidTiming timing() const override { return timing_; }
  bool numbered() const override { return false; }
  void start(hapgrid::HidChannel& channel) override {
    if (while_starting) while_starting();
    channel.write(started());
  }
  bool decode(std::span<const std::uint8_t> report, hapgrid::DeviceInput& input) noexcept override {
    if (report.size() != 3 || report[0] != 0 || report[1] != 0xA5) return false;
    input.position = {report[2] * 1e-3, 0, 0};
    return true;
  }
  void encode(const hapgrid::Vec3& f, std::vector<hapgrid::HidReport>& reports) noexcept override {
    reports.resize(1);
    reports[0].assign({0, 0xF0, static_cast<std::uint8_t>(f[0])});
  }
  std::vector<hapgrid::HidReport> keep_alive() const override { return alive_; }
  std::vector<hapgrid::HidReport> snap() const override { return {snapped()}; }
  std::vector<hapgrid::HidReport> stop() const override { return {stopped()}; }

  std::function<void()> while_starting;

 private:
  hapgrid::HidTiming timing_;
  std::vector<hapgrid::HidReport> alive_;
};
