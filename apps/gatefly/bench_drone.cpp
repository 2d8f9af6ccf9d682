// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cctype>
#include <filesystem>
#include <iostream>
#include <memory>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "gatefly/files/json.hpp"
#include "gatefly/files/output.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/live/bench.hpp"
#include "gatefly/live/uri.hpp"

#include "commands.hpp"

namespace gatefly::cli {
namespace {

using namespace std::chrono_literals;

struct BenchDroneOptions {
  CommonOptions common;
  std::string link, out = "drone.toml";
  live::Told told;
  double turn_s = 60.0;
  bool propellers_off = false, json = false;
};

/// Prints findings as they come, and remembers whether all were well.
class Protocol {
 public:
  Protocol(bool quiet, bool json) : quiet_{quiet}, json_{json} {}
  bool add(const live::Findings& findings) {
    for (const live::Finding& finding : findings) {
      if (json_)
        told_.push_back({{"well", finding.well}, {"line", finding.line}});
      else if (!finding.well || !quiet_)
        std::cout << coloured(finding.well, finding.well ? "well   " : "WRONG  ") << finding.line
                  << std::endl;
    }
    well_ = well_ && live::all_well(findings);
    return live::all_well(findings);
  }
  [[nodiscard]] bool well() const { return well_; }
  /// @param file  that was written; "": none. @return the exit code.
  int end(const std::string& file = "") {
    if (json_)
      std::cout << io::json_text(
          nlohmann::ordered_json{{"well", well_}, {"findings", told_}, {"file", file}});
    else if (!file.empty() && !quiet_)
      std::cout << file
                << ": written; without a hand-over test, which is not built yet: for --shadow\n";
    return file.empty() ? kAnswerIsNo : kDone;
  }

 private:
  bool quiet_, json_, well_ = true;
  nlohmann::json told_ = nlohmann::json::array();
};

bool is_name(const std::string& name) {
  return !name.empty() && name.size() <= 40 &&
         std::all_of(name.begin(), name.end(), [](unsigned char c) {
           return std::isalnum(c) != 0 || c == '-' || c == '_' || c == ' ';
         });
}

/// gatefly bench-drone: exit 0 all is well and the file written, 1 something is wrong with the drone, 2 unusable input.
int bench_drone(const BenchDroneOptions& options) {
  const live::LinkUri uri = live::link_uri(options.link);
  if (uri.kind == live::LinkUri::Kind::kReplay)
    throw std::runtime_error("--link " + options.link + ": a recording is no drone");
  if (!options.propellers_off)
    throw std::runtime_error("--propellers-off is missing: take them off, then say so");
  if (!is_name(options.told.name))
    throw std::runtime_error("--name: must be 1 to 40 letters, digits, '-', '_' and spaces");
  check_outputs({{"--out", options.out, {"file of a drone", live::kDroneFileMark}}}, {},
                options.common);
  live::Port port = uri.kind == live::LinkUri::Kind::kSerial
                        ? live::Port::serial(uri.place, uri.baud)
                        : live::Port::tcp(uri.place, uri.port, live::Clock::now() + 3s);
  const live::Introduction said = live::introduction_of(port);
  Protocol protocol{options.common.quiet, options.json};
  // The checks below need a controller that is known. The link is timed even when a sensor is wrong.
  if (!protocol.add(live::of_introduction(said))) return protocol.end();
  msp::ImuScale scale;
  if (!options.common.quiet)
    std::cerr << "gatefly bench-drone: leave it level and still for three seconds\n";
  if (!protocol.add(live::of_rest(port, 3s, scale))) return protocol.end();
  const auto say = [&](const std::string& what) {
    if (!options.common.quiet) std::cerr << "gatefly bench-drone: " << what << '\n';
  };
  const auto limit = std::chrono::milliseconds{static_cast<int>(1e3 * options.turn_s)};
  protocol.add(live::of_turns(port, scale, limit, say));
  protocol.add(live::of_link(port, *said.facts.order(), 3s));
  if (!protocol.well()) return protocol.end();
  io::write_file(options.out, live::drone_toml(said, scale, options.told));
  return protocol.end(options.out);
}

}  // namespace

void declare_bench_drone(Command& command) {
  auto options = std::make_shared<BenchDroneOptions>();
  command.footer(
      "Example:\n  gatefly bench-drone --propellers-off --link 'msp:/dev/ttyTHS1?baud=115200' "
      "--name archer-1 \\\n"
      "    --hover-stick-us 1425 --exponent 1.6 --least-v 19.8 --out drone.toml\n\n"
      "Exit code 0: all is well, the file is written; 1: something is wrong with the drone, a line "
      "each; 2: unusable arguments,\n"
      "or nobody answers.");
  command.option("--link", options->link, "msp:/dev/ttyX?baud=115200 or msp:tcp:HOST:PORT")
      .required()
      .type_name("URI");
  command.flag("--propellers-off", options->propellers_off,
               "that they are off: neutral stick frames will be sent");
  command.option("--name", options->told.name, "what the drone is called")
      .required()
      .type_name("NAME");
  command
      .option("--hover-stick-us", options->told.hover_stick_us,
              "throttle stick at which it hovers [µs]; no controller knows it")
      .required()
      .between(1000, 2000);
  command.option("--exponent", options->told.exponent, "of thrust over throttle: 1 to 2")
      .required()
      .between(0.8, 3.0);
  command.option("--least-v", options->told.least_v, "battery at which a flight ends [V]")
      .required()
      .between(0.0, 60.0);
  command.option("--turn-s", options->turn_s, "so long it waits for the three turns by hand [s]")
      .between(1.0, 600.0)
      .show_default();
  command.option("--out", options->out, "the file to write").path("FILE").show_default();
  command.flag("--json", options->json, "print the findings as JSON");
  add_force(command, options->common);
  add_common(command, options->common);
  command.runs([options] { return bench_drone(*options); });
}

}  // namespace gatefly::cli
