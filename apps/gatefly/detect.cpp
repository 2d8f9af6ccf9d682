// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <iomanip>
#include <iostream>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>

#include <nlohmann/json.hpp>

#include "gatefly/detection/gate_detector.hpp"
#include "gatefly/drawing/annotate.hpp"
#include "gatefly/drawing/search_sheet.hpp"
#include "gatefly/files/detections_file.hpp"
#include "gatefly/files/image_file.hpp"
#include "gatefly/files/json.hpp"
#include "gatefly/files/pictures.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/files/video_reader.hpp"
#include "gatefly/tasks/assumptions.hpp"
#include "gatefly/tasks/gates_in_picture.hpp"
#include "gatefly/tasks/search_report.hpp"
#include "gatefly/tasks/upright.hpp"

#include "commands.hpp"
#include "drawings.hpp"

namespace gatefly::cli {
namespace {

namespace fs = std::filesystem;

struct DetectOptions {
  CommonOptions common;
  std::vector<std::string> paths;
  bool all = false, json = false;
  std::optional<int> rotate_deg;
  std::string csv, annotate, debug, data;
};

constexpr files::OutputKind kSearchJson{"record of a search", "\"in_words\""};

/// Totals over all pictures.
struct Findings {
  std::vector<files::DetectionRow> rows;
  /// with_part: with no more than a part of a gate.
  int pictures = 0, with_gate = 0, with_part = 0, unusable = 0, grey = 0;
  std::string first_grey;                         ///< Its name.
  int other_size = 0;                             ///< Not of the size of the camera that was named.
  std::string first_other_size;                   ///< Description of the first such picture.
  double seconds = 0.0;                           ///< Spent on detection alone.
  std::unique_ptr<Drawings> annotated, debugged;  ///< With --annotate, --debug.
  std::string rotation;                           ///< How pictures were turned.
};

std::string name_of_drawing(const std::string& picture) { return picture + ".png"; }
std::string name_of_record(const std::string& picture) { return picture + ".json"; }

/// Trace of both searches in a picture.
void debug(const Image& image, const std::string& name, const std::vector<GateDetection>& gates,
           const config::Config& config, const Drawings& drawings) {
  const tasks::SearchReport report = tasks::explained(image, config.pilot, gates);
  drawing::SearchSheet sheet{.title = name,
                             .in_words = report.in_words,
                             .found = report.answered,
                             .fast = {report.fast.begin(), report.fast.end()},
                             .map = report.map,
                             .bars = report.bars,
                             .trace = report.trace,
                             .listed = {}};
  for (const tasks::ConsideredFrame& frame : report.considered)
    sheet.listed.push_back({frame.bars_px, frame.score, frame.taken, frame.fate});
  drawings.write(name_of_drawing(name), files::kOurPng, drawing::drawn(sheet, image).png());
  drawings.write(name_of_record(name), kSearchJson, files::json_text(tasks::as_json(report)));
}

/// Whether a picture has no colour anywhere, by every 5th pixel of every 5th line.
bool is_grey(const Image& image) {
  constexpr int kEvery = 5, kNearGrey = 3;  // a grey JPEG's chroma is 128 to a level or two
  const auto grey = [](std::uint8_t chroma) { return std::abs(chroma - 128) <= kNearGrey; };
  for (int v = 0; v < image.height(); v += kEvery)
    for (int u = 0; u < image.width(); u += kEvery)
      if (const Yuv color = image.at(u, v); !grey(color.u) || !grey(color.v)) return false;
  return true;
}

/// One picture: detected, added to the findings, drawn.
void look_at(const Image& image, const std::string& name, const DetectOptions& options,
             const config::Config& config, GateDetector& detector, Findings& findings) {
  const auto start = std::chrono::steady_clock::now();
  const std::vector<GateDetection> gates =
      tasks::gates_in_picture(image, detector, config.pilot, options.all);
  findings.seconds +=
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  ++findings.pictures;
  if (gates.empty() && is_grey(image) && findings.grey++ == 0) findings.first_grey = name;
  if (!gates.empty())
    ++(gates[0].method == DetectionMethod::kBars ? findings.with_part : findings.with_gate);
  for (std::size_t i = 0; i < gates.size(); ++i)
    findings.rows.push_back(files::row_of(name, static_cast<int>(i), gates[i]));
  if (findings.annotated)
    findings.annotated->write(name_of_drawing(name), files::kOurPng,
                              drawing::annotated(image, gates).png());
  if (findings.debugged) debug(image, name, gates, config, *findings.debugged);
}

/// Counts a picture that the camera of a --config does not make: its lens is then not that one's.
void compare_size(const files::ImageFile& file, const std::string& name,
                  const config::Config& config, Findings& findings) {
  const auto told = config.set_by.find("camera.size_px");
  const int width = config.camera.stored_width(), height = config.camera.stored_height();
  if (told == config.set_by.end() || (file.stored_width == width && file.stored_height == height))
    return;
  if (findings.other_size++ > 0) return;
  findings.first_other_size = name + " has " + std::to_string(file.stored_width) + "x" +
                              std::to_string(file.stored_height) + " px, the camera of " +
                              told->second + " stores " + std::to_string(width) + "x" +
                              std::to_string(height) + ": its lens does not fit";
}

using Look = std::function<void(const files::ImageFile&, const std::string& name)>;

/// Every picture of a file: itself, or a video's frames "f7.avi#12".
void each_picture(const fs::path& path, const config::Config& config, bool as_stored,
                  const Look& look) {
  const std::string name = path.filename().string();
  if (name.find_first_of(",\"\r\n") != std::string::npos)
    throw std::runtime_error(
        path.string() + ": its name must be without comma, quote and line break to stand in a CSV");
  if (files::is_picture(path))
    return look(
        files::read_image(path, config.camera.stored_width(), config.camera.stored_height()), name);
  files::VideoReader video(
      path, as_stored ? files::VideoReader::As::kStored : files::VideoReader::As::kUpright);
  for (int frame = 0; !interrupted(); ++frame) {
    const auto picture = video.next();
    if (!picture) return;
    look(*picture, name + "#" + std::to_string(frame));
  }
}

void complain(const std::string& what) { std::cerr << "gatefly detect: " << what << '\n'; }

/// All files that the command line names; what cannot be used is said and counted.
std::vector<fs::path> all_files(const DetectOptions& options, Findings& findings) {
  std::vector<fs::path> files;
  std::map<std::string, fs::path> folder_of;
  bool warned = false;
  for (const std::string& path : options.paths) try {
      const fs::path found = data_at(path, options.data);
      const std::vector<fs::path> pictures = files::picture_files(found);
      if (const std::string others = files::left_out_of(found); !others.empty()) complain(others);
      for (const fs::path& file : pictures) {
        files.push_back(file);
        const auto [other, is_new] =
            folder_of.try_emplace(file.filename().string(), file.parent_path());
        if (!is_new && !std::exchange(warned, true))
          complain("warning: " + file.string() + " and one in '" +
                   (other->second.empty() ? "." : other->second.string()) +
                   "' have the same name, and so have their rows");
      }
    } catch (const std::exception& error) {
      complain(files::reason_of(error));
      ++findings.unusable;
    }
  return files;
}

/// Before the work: whether what is drawn of all these files may be.
void open_drawings(const DetectOptions& options, const std::vector<fs::path>& files,
                   Findings& findings) {
  const std::vector<files::Output> table{{"--csv", options.csv, {}}};
  if (!options.annotate.empty()) {
    findings.annotated =
        std::make_unique<Drawings>("--annotate", options.annotate, table, options.common.force);
    for (const fs::path& file : files)
      findings.annotated->check(name_of_drawing(file.filename().string()), files::kOurPng);
  }
  if (options.debug.empty()) return;
  findings.debugged =
      std::make_unique<Drawings>("--debug", options.debug, table, options.common.force);
  for (const fs::path& file : files) {
    findings.debugged->check(name_of_drawing(file.filename().string()), files::kOurPng);
    findings.debugged->check(name_of_record(file.filename().string()), kSearchJson);
  }
}

Findings look_everywhere(const DetectOptions& options, const config::Config& config) {
  Findings findings;
  GateDetector detector{config.pilot.detector, config.pilot.detector_mode};
  const std::vector<fs::path> files = all_files(options, findings);
  tasks::Upright upright(config);
  open_drawings(options, files, findings);
  Progress progress(options.common.quiet, 10'000.0);
  double done = 0.0;
  for (const fs::path& path : files) {
    if (interrupted()) break;
    try {
      each_picture(path, config, upright.told(),
                   [&](const files::ImageFile& file, const std::string& name) {
                     compare_size(file, name, config, findings);
                     look_at(upright.view(file, path), name, options, config, detector, findings);
                     if (progress.due(findings.pictures))
                       progress.update(done / static_cast<double>(files.size()),
                                       files::amount(findings.pictures, "picture") + ", " +
                                           std::to_string(findings.with_gate) + " with a gate");
                   });
    } catch (const files::CannotWrite&) {  // not the picture's fault: the next would end so, too
      throw;
    } catch (const std::exception& error) {
      progress.clear();
      complain(files::reason_of(error));
      ++findings.unusable;
    }
    ++done;
  }
  progress.clear();
  findings.rotation = upright.said();
  if (findings.pictures > 0 && !options.common.quiet)
    complain(findings.rotation + "; " + tasks::text_of(tasks::assumptions_of(config)));
  if (findings.other_size > 0 && !options.common.quiet)
    complain(findings.first_other_size +
             (findings.other_size > 1 ? " (" + std::to_string(findings.other_size) + " of " +
                                            files::amount(findings.pictures, "picture") + ")"
                                      : ""));
  if (findings.grey > 0 && !options.common.quiet)
    complain(std::to_string(findings.grey) + " of " + files::amount(findings.pictures, "picture") +
             (findings.grey == 1 ? " has" : " have") + " no colour, by which gates are found: " +
             findings.first_grey + (findings.grey > 1 ? ", ..." : ""));
  return findings;
}

nlohmann::ordered_json as_json(const Findings& findings, const config::Config& config) {
  nlohmann::ordered_json detections = nlohmann::ordered_json::array();
  for (const files::DetectionRow& row : findings.rows) {
    nlohmann::ordered_json corners = nlohmann::ordered_json::array();
    for (const auto& corner : row.corners_px) corners.push_back({corner.x(), corner.y()});
    detections.push_back({{"image", row.image},
                          {"gate", row.gate},
                          {"corners_px", corners},
                          {"fitness", row.fitness},
                          {"method", row.method},
                          {"corner_fitness", row.corner_fitness}});
  }
  nlohmann::ordered_json assumed = tasks::as_json(tasks::assumptions_of(config));
  assumed["rotation"] = findings.rotation;
  return {{"pictures", findings.pictures},     {"with_gate", findings.with_gate},
          {"with_part", findings.with_part},   {"unusable", findings.unusable},
          {"other_size", findings.other_size}, {"assumed", assumed},
          {"detections", detections}};
}

void print_summary(const Findings& findings, const std::string& csv) {
  std::cout << std::fixed << std::setprecision(2) << findings.with_gate << " of "
            << files::amount(findings.pictures, "picture")
            << (findings.with_gate == 1 ? " shows a gate, " : " show a gate, ")
            << findings.with_part << " more a part of one, "
            << 1e3 * findings.seconds / std::max(findings.pictures, 1)
            << " ms each to detect: " << csv << '\n';
}

/// gatefly detect: exit 0 something detected, 1 nothing, 2 unusable input (the rest is done), 130
/// Ctrl-C.
int detect(const DetectOptions& options) {
  const std::string csv = options.csv.empty() && !options.json ? "-" : options.csv;
  const bool rows_on_stdout = files::is_stdout(csv);
  if (options.json && rows_on_stdout)
    throw std::runtime_error("--json and --csv " + csv + ": both want stdout; name a file");
  if (!options.debug.empty() && fs::path{options.debug} == fs::path{options.annotate})
    throw std::runtime_error("--debug " + options.debug +
                             ": --annotate draws there, too; name another folder");
  std::vector<fs::path> inputs;
  for (const std::string& path : options.paths) inputs.push_back(data_at(path, options.data));
  check_outputs({{"--csv", csv, {"table of detections", "image,gate,tl_u,"}}}, inputs,
                options.common);
  CommonOptions common = options.common;
  if (options.rotate_deg)
    common.settings.push_back("camera.stored_rotation_deg=" + std::to_string(*options.rotate_deg));
  const config::Config config = load(common);

  catch_interrupt();
  const Findings findings = look_everywhere(options, config);
  if (interrupted()) {
    complain("interrupted, nothing kept");
    return kInterrupted;
  }
  if (findings.pictures == 0) return kUnusable;
  if (findings.unusable > 0)
    complain(std::to_string(findings.unusable) + " could not be used, " +
             files::amount(findings.pictures, "picture") +
             (findings.pictures == 1 ? " was done" : " were done"));

  if (!csv.empty()) files::write_file(csv, files::detections_csv(findings.rows));
  if (findings.annotated) findings.annotated->pour();
  if (findings.debugged) findings.debugged->pour();
  if (options.json)
    std::cout << files::json_text(as_json(findings, config));
  else if (!rows_on_stdout && !options.common.quiet)
    print_summary(findings, csv);
  if (findings.unusable > 0) return kUnusable;
  return findings.with_gate + findings.with_part > 0 ? kDone : kAnswerIsNo;
}

}  // namespace

void declare_detect(Command& command) {
  auto options = std::make_shared<DetectOptions>();
  command.footer(
      "Example:\n  gatefly detect photo.jpg clip.mp4 --annotate out/drawn\n"
      "  gatefly detect ../shared/data/tudelft_bebop_gates/cyberzoo --config cyberzoo --csv "
      "found.csv\n\n"
      "A folder means its jpg, png and ppm files; raw .uyvy (of the camera's size) only when "
      "named; anything else is\n"
      "read as a video by ffmpeg. A gate that the border cuts is a row of method bars, which\n"
      "score leaves out: a corner of fitness 0 is not in view, there the bar leaves the picture; "
      "with whole gates in the\n"
      "picture only with --all. Exit code 0: a gate was detected; 1: none; 2: something could not "
      "be used (the\n"
      "rest is done); 130: Ctrl-C.");
  command.option("PATH", options->paths, "images, folders, videos").required().path();
  command.flag("--all", options->all, "every gate, best first, instead of the best");
  command
      .option("--rotate", options->rotate_deg,
              "turn stored pictures counter-clockwise [as the camera of a --config, else EXIF, "
              "else upright]")
      .one_of({0, 90, 180, 270})
      .type_name("DEG");
  command.option("--csv", options->csv, "where rows go instead of stdout (-)").path("FILE");
  command
      .option("--annotate", options->annotate, "draw every picture with its gates: DIR/<image>.png")
      .path("DIR");
  command
      .option("--debug", options->debug,
              "draw why gates were found or missed: DIR/<image>.png, the same as numbers in "
              "<image>.json")
      .path("DIR");
  command
      .option("--data", options->data,
              "where a PATH is looked for that is not here [$GATEFLY_DATA]")
      .path("DIR");
  command.flag("--json", options->json, "print JSON");
  add_force(command, options->common);
  add_common(command, options->common);
  command.runs([options] { return detect(*options); });
}

}  // namespace gatefly::cli
