// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <stdexcept>

#include "gatefly/files/json.hpp"
#include "gatefly/files/pictures.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/tasks/calibration/boards.hpp"
#include "gatefly/tasks/calibration/calibration.hpp"
#include "gatefly/tasks/calibration/calibration_report.hpp"
#include "gatefly/tasks/calibration/camera_file.hpp"
#include "gatefly/tasks/calibration/mount_source.hpp"
#include "gatefly/tasks/calibration/residual_picture.hpp"
#include "gatefly/tasks/calibration/stored_rotation.hpp"

#include "commands.hpp"

namespace gatefly::cli {
namespace {

namespace fs = std::filesystem;
using namespace calibration;

struct CalibrateOptions {
  CommonOptions common;
  std::vector<std::string> paths, zero;
  std::string out, from, to = "toml", model, camera, report, data, tilt_from;
  BoardArguments board;
  std::optional<double> gate_height;
  std::optional<int> rotate_deg;
  bool json = false;

  [[nodiscard]] bool writes_to_stdout() const {
    return files::is_stdout(out) || files::is_stdout(report);
  }
  [[nodiscard]] bool prints() const { return !json && !common.quiet && !writes_to_stdout(); }
};

void complain_of_boards(const std::string& what) {
  std::cerr << "gatefly calibrate: " << what << '\n';
}

std::vector<fs::path> all_files(const CalibrateOptions& options) {
  std::vector<fs::path> files;
  for (const std::string& path : options.paths)
    for (const fs::path& file : files::picture_files(data_at(path, options.data)))
      files.push_back(file);
  return files;
}

Boards find_boards(const CalibrateOptions& options) {
  Boards boards;
  const std::vector<fs::path> files = all_files(options);
  Progress progress(options.common.quiet, 10.0);
  std::optional<BoardPattern> pattern;
  double done = 0.0;
  for (const fs::path& file : files) {
    if (interrupted()) break;
    if (is_corner_list(file)) {
      boards.add_list(file, options.board);
    } else {
      if (!pattern) pattern = pattern_of(options.board);
      try {
        boards.add_picture(file, *pattern, options.board.rotate_deg);
      } catch (const std::exception& error) {
        if (files.size() == 1) throw;
        progress.clear();
        complain_of_boards(files::reason_of(error));
        ++boards.unusable;
      }
    }
    ++done;
    if (progress.due(done))
      progress.update(done / static_cast<double>(files.size()),
                      files::amount(boards.views.size(), "board") + " in " +
                          files::amount(boards.pictures, "picture"));
  }
  progress.clear();
  if (!interrupted() && boards.pictures > 0) expect_enough(boards, options.board);
  return boards;
}

/// The camera and, of a calibration, the picture of its residuals.
void write(const CameraFile& camera, const CalibrateOptions& options,
           std::vector<std::string> comments, const Calibration* answer) {
  if (camera.stored_rotation_deg != 0 && options.to != "toml")
    comments.push_back("Of the upright picture: the stored one turned " +
                       std::to_string(camera.stored_rotation_deg) + " degrees counter-clockwise.");
  const std::string text = camera_text(camera, camera_format(options.to), comments);
  std::vector<files::FileContent> files;
  if (!options.out.empty()) files.push_back({options.out, text});
  if (answer != nullptr && !options.report.empty())
    files.push_back({options.report, residual_picture(*answer).png()});
  files::write_files(files);
}

/// Adds the mount angle to the camera, and what it rests on to the comments.
void add_tilt(CameraFile& camera, const CalibrateOptions& options,
              std::vector<std::string>& comments) {
  if (options.tilt_from.empty()) return;
  const config::Config config = load(options.common);
  const fs::path path = data_at(options.tilt_from, options.data);
  const files::Labels labels = gate_labels(path);
  try {
    const FoundMount found = mount_from(path, labels, camera.lens,
                                        {.gate_side = config.gate.side,
                                         .p_BC = config.camera.p_BC,
                                         .gate_height = options.gate_height});
    camera.tilt_down = found.mount.tilt_down;
    comments.push_back(text_of(found));
  } catch (const std::exception& error) {
    throw std::runtime_error("--tilt-from " + options.tilt_from + ": " + error.what());
  }
  if (options.prints()) std::cout << comments.back() << '\n';
}

int convert(const CalibrateOptions& options) {
  if (!options.paths.empty())
    throw std::runtime_error("--from " + options.from +
                             ": takes the camera from that file, no pictures besides");
  if (options.out.empty())
    throw std::runtime_error("--from " + options.from +
                             ": --out is missing: where to (- for stdout)");
  const fs::path path = data_at(options.from, options.data);
  CameraFile camera = read_camera(path, options.camera);
  std::vector<std::string> comments{"From " + path.filename().string() + " by gatefly calibrate."};
  add_tilt(camera, options, comments);
  expect_usable(camera, path.string());
  write(camera, options, comments, nullptr);
  return kDone;
}

/// Before the work: flags that contradict each other, outputs that may not be written.
void expect_sensible(const CalibrateOptions& options) {
  std::vector<fs::path> inputs = all_files(options);
  for (const std::string& input : {options.from, options.tilt_from})
    if (!input.empty()) inputs.push_back(data_at(input, options.data));
  check_outputs({{"--out", options.out, {"camera of gatefly calibrate", "by gatefly calibrate"}},
                 {"--report", options.report, files::kOurPng}},
                inputs, options.common);
  if (!options.from.empty()) return;
  if (options.paths.empty())
    throw std::runtime_error(
        "neither pictures nor a corner list nor --from is given (--help shows an example)");
  if (options.writes_to_stdout() && options.json)
    throw std::runtime_error("--json and --out or --report -: both want stdout; name a file");
}

/// How the camera stores pictures, as a flight shows where corner lists and flags do not say it.
std::optional<int> rotation_by_flight(const Boards& boards, const CalibrateOptions& options) {
  if (!boards.listed || options.rotate_deg || options.tilt_from.empty()) return std::nullopt;
  const fs::path flight = data_at(options.tilt_from, options.data);
  if (!fs::is_directory(flight)) return std::nullopt;
  const config::Config config = load(options.common);
  return stored_rotation_of(flight, boards.size_px, config.pilot.detector, config.pilot.gate_color);
}

void print(const Calibration& answer, const Boards& boards, const CalibrateOptions& options,
           const std::string& doubt) {
  std::cout << text_of(answer, boards);
  if (!options.out.empty())
    std::cout << options.out << ": " << name_of(answer.best().fit.model) << '\n';
  if (!doubt.empty()) std::cout << "warning: " << doubt << '\n';
}

/// Fits, writes and prints what the boards tell.
void answer_with(const Boards& boards, const CalibrateOptions& options) {
  CalibrationOptions how;
  how.model = lens_model(options.model);
  how.zero = options.zero;
  const Calibration answer = calibration::calibrate(boards.views, boards.size_px, how);
  std::vector<std::string> comments = provenance(answer);
  const std::optional<int> by_flight = rotation_by_flight(boards, options);
  if (by_flight)
    comments.push_back("stored_rotation_deg: so the gates of " +
                       data_at(options.tilt_from, options.data).filename().string() +
                       " are where its labels have them.");
  CameraFile camera{short_lens(answer.best().fit),
                    answer.size_px,
                    by_flight.value_or(options.board.rotate_deg),
                    {}};
  const std::string doubt = options.rotate_deg || by_flight ? "" : stored_rotation_doubt(boards);
  if (!doubt.empty()) comments.push_back("Beware: " + doubt + ".");
  add_tilt(camera, options, comments);
  expect_usable(camera, "the fitted lens");
  write(camera, options, comments, &answer);
  if (options.json)
    std::cout << files::json_text(as_json(answer, boards, camera.stored_rotation_deg, doubt));
  else if (options.prints())
    print(answer, boards, options, doubt);
}

/// gatefly calibrate: exit 0 done, 2 no camera comes out (or, at the end, a picture could not be
/// read), 130 Ctrl-C.
int run_calibrate(const CalibrateOptions& options) {
  expect_sensible(options);
  if (!options.from.empty()) return convert(options);
  catch_interrupt();
  const Boards boards = find_boards(options);
  if (interrupted()) {
    complain_of_boards("interrupted, nothing written");
    return kInterrupted;
  }
  if (boards.pictures == 0) return kUnusable;  // each was said
  answer_with(boards, options);
  if (boards.unusable == 0) return kDone;
  complain_of_boards(files::amount(boards.unusable, "picture") +
                     " could not be used, the rest was");
  return kUnusable;
}

}  // namespace

void declare_calibrate(Command& command) {
  auto options = std::make_shared<CalibrateOptions>();
  command.footer(
      "Example:\n  gatefly calibrate pictures/ --pattern 9x6 --square-m 0.03 --out camera.toml\n"
      "  gatefly detect photo.jpg --config camera.toml\n"
      "  gatefly calibrate corners.csv --size 640x480 --model kannala-brandt --to kalibr --out "
      "camchain.yaml\n"
      "  gatefly calibrate --from camchain.yaml --out camera.toml\n\n"
      "Take 20 sharp pictures of a flat board, tilted by 30° to all sides, in every part of the "
      "picture. --pattern counts\n"
      "inner corners: 9x6 is a board of 10x7 squares. A corner list is a CSV with a row for each "
      "corner: image (or view),\n"
      "X_m,Y_m (or X_mm,Y_mm) on the board, u_px,v_px from 0 (or u_px_1based,v_px_1based). Four "
      "lenses are fitted; the one\n"
      "with the fewest parameters that is as good as the best in pictures it has not seen is "
      "written. Exit code 2: no camera\n"
      "can be had from these pictures, the reason is said; or a picture could not be read (the "
      "rest was done).");
  command.option("PATH", options->paths, "pictures, folders of them, corner lists (.csv)").path();
  command.option("--out", options->out, "where the camera goes (- for stdout)").path("FILE");
  Flag pattern =
      command.option("--pattern", options->board.pattern, "inner corners of the checkerboard")
          .type_name("COLUMNSxROWS");
  Flag square = command.option("--square-m", options->board.square, "side of a square")
                    .between(1e-4, 10.0)
                    .type_name("METRES");
  Flag size =
      command.option("--size", options->board.size, "of the stored pictures behind a corner list")
          .type_name("WxH");
  Flag rotate = command
                    .option("--rotate", options->rotate_deg,
                            "turn stored pictures (and listed corners) counter-clockwise [0]")
                    .one_of({0, 90, 180, 270})
                    .type_name("DEG");
  Flag model = command.option("--model", options->model, "this lens instead of the recommended one")
                   .one_of({"pinhole", "dhane", "kannala-brandt", "brown-conrady"})
                   .type_name("MODEL");
  Flag zero = command
                  .option("--zero", options->zero,
                          "distortion coefficients that stay 0: p1,p2 is no "
                          "tangential distortion, k3 is\nKalibr's radtan")
                  .one_of({"k1", "k2", "k3", "k4", "p1", "p2"})
                  .separated_by(',')
                  .one_value_each()
                  .type_name("NAMES");
  command
      .option("--to", options->to,
              "what to write: toml (ours), kalibr (camchain), ros (camera_info) [toml]")
      .one_of({"toml", "kalibr", "ros"})
      .type_name("FORMAT");
  Flag from =
      command
          .option("--from", options->from,
                  "no pictures: the camera of a Kalibr camchain, ROS camera_info or our .toml")
          .path("FILE");
  command.option("--camera", options->camera, "which of a camchain's cameras")
      .needs(from)
      .type_name("NAME");
  Flag tilt =
      command
          .option("--tilt-from", options->tilt_from,
                  "mount angle from a labels.csv of gates that a level drone saw,\nor from a "
                  "flight folder with labels.csv and motion capture")
          .path("FILE|DIR");
  command
      .option("--gate-height-m", options->gate_height,
              "for a labels.csv: the gates' middle above the camera, to 5 cm")
      .between(-10.0, 10.0)
      .needs(tilt)
      .type_name("METRES");
  Flag report = command.option("--report", options->report, "draw all residuals").path("PNG");
  command
      .option("--data", options->data,
              "where a PATH is looked for that is not here [$GATEFLY_DATA]")
      .path("DIR");
  Flag json = command.flag("--json", options->json, "print JSON");
  add_force(command, options->common);
  for (Flag other : {pattern, square, size, rotate, model, zero, report, json})
    from.excludes(other);
  add_common(command, options->common);
  command.runs([options] {
    options->board.rotate_deg = options->rotate_deg.value_or(0);
    return run_calibrate(*options);
  });
}

}  // namespace gatefly::cli
