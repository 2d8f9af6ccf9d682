// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>
#include <functional>
#include <iomanip>
#include <iostream>
#include <memory>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

#include <nlohmann/json.hpp>

#include "gatefly/config/track_file.hpp"
#include "gatefly/drawing/video_file.hpp"
#include "gatefly/files/json.hpp"
#include "gatefly/files/pictures.hpp"
#include "gatefly/files/shipped_files.hpp"
#include "gatefly/files/subprocess.hpp"
#include "gatefly/files/text.hpp"

#include "commands.hpp"

namespace gatefly::cli {
namespace {

namespace fs = std::filesystem;

struct DoctorOptions {
  CommonOptions common;
  bool json = false;
};

/// One thing that gatefly may need, and whether it is there.
struct Check {
  std::string name;
  bool needed = false;  ///< No race without it.
  bool ok = false;
  std::string found;   ///< The version found, or the fault.
  std::string advice;  ///< Remedy when it is not ok.
};

/// ok with what `look` answers, else not ok with the reason of what it throws.
Check check(const char* name, bool needed, const std::string& advice,
            const std::function<std::string()>& look) {
  try {
    return {name, needed, true, look(), advice};
  } catch (const std::exception& error) {
    return {name, needed, false, files::reason_of(error), advice};
  }
}

bool has_command(std::string_view name) {
  const auto here = commands_here();
  return std::any_of(here.begin(), here.end(), [&](const CommandHere& command) {
    return command.name == name && command.declare != nullptr;
  });
}

std::string simulator() {
  if (!has_command("fly")) throw std::runtime_error("this program was built without it");
  return "built in";
}

std::string processor() {
#if defined(__x86_64__)
  if (!__builtin_cpu_supports("avx2")) throw std::runtime_error("has no AVX2");
  return "has AVX2";
#else
  throw std::runtime_error("is no x86-64, has no AVX2");
#endif
}

std::string shipped_files() {
  const fs::path folder = files::shipped_dir();
  if (folder.empty()) throw std::runtime_error("no share/gatefly above the program");
  return folder.string();
}

std::string configuration(const CommonOptions& options) {
  (void)load(options);
  return "loads";
}

std::string track() {
  const fs::path path = config::find_track("showroom");
  (void)config::read_track(path);
  return path.string();
}

/// A folder that can be written to, be it there already or not.
std::string writable(const fs::path& folder) {
  files::check_output_folder("folder", folder);
  return folder.string();
}

/// Where the program is that has `command`. @throws std::runtime_error when it was not built.
std::string program_with(const char* command, const char* name) {
  if (has_command(command)) return "in this program";
  const fs::path program = sibling(name);
  if (!fs::exists(program)) throw std::runtime_error(program.string() + ": is not there");
  return program.string();
}

std::string python_module() {
  pid_t pid = -1;
  const int error = files::start({"python3", "-c", "import gatefly"}, {}, pid);
  if (error != 0) throw std::runtime_error("python3: " + std::system_category().message(error));
  if (files::wait_for(pid) != 0) throw std::runtime_error("python3 cannot import gatefly");
  return "python3 imports gatefly";
}

std::string ffmpeg() {
  files::require_ffmpeg();
  return "runs";
}

std::string real_data() {
  const fs::path folder = files::data_folder();
  std::error_code error;
  std::vector<std::string> sets;
  for (const auto& entry : fs::directory_iterator(folder, error))
    if (entry.is_directory(error)) sets.push_back(entry.path().filename().string());
  if (sets.empty()) throw std::runtime_error(folder.string() + ": no data set there");
  std::sort(sets.begin(), sets.end());
  return folder.string() + ": " + files::joined(sets);
}

std::vector<Check> examined(const CommonOptions& options) {
  return {
      check("simulator", true,
            "build with -DGATEFLY_SIMULATOR=ON (needs MuJoCo and Embree); ./gatefly does",
            simulator),
      check("processor", true,
            "pictures cannot be rendered on it (Embree); fly --vision ideal works without",
            processor),
      check("shipped files", true,
            "install gatefly as a whole, or name the folder above gatefly/ in $XDG_DATA_DIRS",
            shipped_files),
      check("configuration", true, "gatefly config --show says more",
            [&] { return configuration(options); }),
      check("track", true, "give a track by its file", track),
      check("out folder", true, "start gatefly in a folder of yours, or say --out",
            [] { return writable("out"); }),
      check("cache folder", false, "light maps are baked again each time; set $XDG_CACHE_HOME",
            [] { return writable(files::cache_dir()); }),
      check("laboratory", false, "calibrate, tune, identify need it: ninja gatefly-lab",
            [] { return program_with("calibrate", kLaboratory); }),
      check("studies", false, "reproduce, bench need it: ninja gatefly-studies",
            [] { return program_with("reproduce", kStudies); }),
      check("ffmpeg", false, "films and videos need it: apt-get install ffmpeg", ffmpeg),
      check("Python module", false,
            "install the package, or set PYTHONPATH to the build folder's python/", python_module),
      check("real data", false, "recorded flights and pictures: set $GATEFLY_DATA to their folder",
            real_data),
  };
}

void print(const std::vector<Check>& checks) {
  for (const auto& [name, needed, ok, found, advice] : checks) {
    std::cout << "  " << coloured(ok, ok ? "ok     " : "missing") << "  " << std::left
              << std::setw(15) << name << found << '\n';
    if (!ok) std::cout << std::string(11 + 15, ' ') << "-> " << advice << '\n';
  }
}

nlohmann::json as_json(const std::vector<Check>& checks) {
  auto list = nlohmann::json::array();
  for (const auto& [name, needed, ok, found, advice] : checks)
    list.push_back({{"name", name},
                    {"needed_to_fly", needed},
                    {"ok", ok},
                    {"found", found},
                    {"advice", ok ? nlohmann::json(nullptr) : nlohmann::json(advice)}});
  return list;
}

/// gatefly doctor: what is installed. Exit 0 a race can be flown, 1 not.
int doctor(const DoctorOptions& options) {
  const std::vector<Check> checks = examined(options.common);
  std::vector<std::string> lacking;
  for (const Check& each : checks)
    if (each.needed && !each.ok) lacking.push_back(each.name);
  if (options.json) {
    const nlohmann::json answer = {
        {"version", GATEFLY_VERSION}, {"can_fly", lacking.empty()}, {"checks", as_json(checks)}};
    std::cout << files::json_text(answer);
  } else {
    std::cout << "gatefly " << GATEFLY_VERSION << ": "
              << (lacking.empty() ? "a race can be flown"
                                  : "no race can be flown, for want of: " + files::joined(lacking))
              << '\n';
    if (!options.common.quiet) print(checks);
  }
  return lacking.empty() ? kDone : kAnswerIsNo;
}

}  // namespace

void declare_doctor(Command& command) {
  auto options = std::make_shared<DoctorOptions>();
  command.footer(
      "Example:\n  gatefly doctor\n\n"
      "Exit code 0: a race can be flown, with rendered pictures, into ./out; 1: it cannot.\n"
      "What is missing and not needed for that is said, too.");
  command.flag("--json", options->json, "print the answer as JSON");
  add_common(command, options->common);
  command.runs([options] { return doctor(*options); });
}

}  // namespace gatefly::cli
