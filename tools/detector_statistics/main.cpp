// SPDX-License-Identifier: Apache-2.0
// What detectors make of pictures, rendered and real, as ideal vision needs it.
//
//   tools/detector_statistics/renew.sh                  builds, measures, writes the simulator's table
//   build/release/detector_statistics                   prints
//   build/release/detector_statistics --days 4          sooner, coarser
//   build/release/detector_statistics --wide            wide gates by a camera tilted up
//   build/release/detector_statistics --ideal           measures what ideal vision draws: about the same
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <stdexcept>
#include <string>

#include "real.hpp"
#include "rendered.hpp"
#include "tables.hpp"

namespace {

using namespace gatefly;

struct Arguments {
  int seeds = 12;
  bool ideal = false, real = true, wide = false;
  std::string write, data;
};

Arguments read(int argc, char** argv) {
  Arguments given;
  for (int i = 1; i < argc; ++i) {
    const std::string flag = argv[i];
    const auto value = [&] {
      if (i + 1 >= argc) throw std::invalid_argument(flag + " needs a value");
      return std::string{argv[++i]};
    };
    if (flag == "--days")
      given.seeds = std::atoi(value().c_str());
    else if (flag == "--write")
      given.write = value();
    else if (flag == "--data")
      given.data = value();
    else if (flag == "--ideal")
      given.ideal = true;
    else if (flag == "--wide")
      given.wide = true;
    else if (flag == "--no-real")
      given.real = false;
    else
      throw std::invalid_argument(
          "usage: detector_statistics [--days N] [--write FILE] "
          "[--data DIR] [--no-real] [--wide] [--ideal]");
  }
  if (given.seeds < 1) throw std::invalid_argument("--days must be 1 or more");
  return given;
}

void write(const std::string& path, const std::string& header) {
  if (path.empty()) return;
  std::ofstream file{path};
  file << header;
  if (!file.flush()) throw std::runtime_error(path + ": cannot be written");
}

/// Gates of 2.7 m with boards of 0.6 m, by a camera that is tilted up; our detector alone.
void run_wide(const Arguments& given) {
  namespace m = gatefly::measuring;
  m::LooksOfBoth looks;
  m::look_at({.track = "grandprix",
              .configs = {"cameras/grandprix.toml"},
              .first_seed = 1001,
              .seeds = given.seeds,
              .ideal = given.ideal,
              .paper = false},
             looks);
  std::fprintf(stderr, "\n");
  m::print(given.ideal ? "wide gates, drawn by ideal vision" : "wide gates, rendered",
           looks[m::kOurs]);
  if (given.ideal) return;
  auto table = m::fitted(looks[m::kOurs], {});
  table.lower = {};  // told among the cut ones
  m::print("wide gates", table);
  write(given.write, m::header_of({{"kOurDetectorOfWideGates", table}},
                                  std::to_string(looks[m::kOurs].pictures) +
                                      " rendered pictures of wide gates"));
}

void run(const Arguments& given) {
  namespace m = gatefly::measuring;
  m::LooksOfBoth rendered;
  const int less = (given.seeds + 1) / 2;
  for (const auto& [track, seeds] : {std::pair{"oval", given.seeds},
                                     {"showroom", given.seeds},
                                     {"figure8", less},
                                     {"lanes", less},
                                     {"tests/courses/slalom_hall.toml", less}})
    m::look_at({.track = track, .first_seed = 1001, .seeds = seeds, .ideal = given.ideal},
               rendered);
  std::fprintf(stderr, "\n");
  m::RealLooks real;
  if (given.real && !given.ideal) real = m::look_at_real(given.data);
  const char* source = given.ideal ? "drawn by ideal vision" : "rendered";
  for (const auto& [detector, name] : {std::pair{m::kOurs, "ours"}, {m::kPaper, "paper"}}) {
    m::print(std::string{name} + ", " + source, rendered[detector]);
    if (real.clear[detector].pictures == 0) continue;
    m::print(std::string{name} + ", real, careful pictures", real.clear[detector]);
    m::print(std::string{name} + ", real, recoded video (basement580)", real.video[detector]);
  }
  if (given.ideal) return;
  const auto ours = m::fitted(rendered[m::kOurs], real.clear[m::kOurs]),
             paper = m::fitted(rendered[m::kPaper], real.clear[m::kPaper]);
  m::print("ours", ours);
  m::print("paper", paper);
  const std::string on = std::to_string(rendered[m::kOurs].pictures) + " rendered and " +
                         std::to_string(real.clear[m::kOurs].pictures) + " real pictures";
  write(given.write, m::header_of({{"kOurDetector", ours}, {"kPapersDetector", paper}}, on));
}

}  // namespace

int main(int argc, char** argv) try {
  const Arguments given = read(argc, argv);
  given.wide ? run_wide(given) : run(given);
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "detector_statistics: %s\n", error.what());
  return 2;
}
