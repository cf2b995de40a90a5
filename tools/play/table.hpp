// The table [play] of a TOML file as options; what else is in the file is other filters'.
#pragma once

#include <CLI/CLI.hpp>
#include <istream>
#include <string>
#include <vector>

namespace hapgrid {

class PlayTable : public CLI::Config {
 public:
  std::string to_config(const CLI::App*, bool, bool, std::string) const override { return ""; }
  /// @throw CLI::ConfigError "--config: line N: ..."
  std::vector<CLI::ConfigItem> from_config(std::istream& input) const override;
};

}  // namespace hapgrid
