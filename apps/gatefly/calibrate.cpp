// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "gatefly/calibration/board_finder.hpp"
#include "gatefly/calibration/calibration.hpp"
#include "gatefly/calibration/camera_file.hpp"
#include "gatefly/calibration/corner_list.hpp"
#include "gatefly/calibration/mount.hpp"
#include "gatefly/calibration/residual_picture.hpp"
#include "gatefly/detection/gate_detector.hpp"
#include "gatefly/files/image_file.hpp"
#include "gatefly/files/json.hpp"
#include "gatefly/files/labels_file.hpp"
#include "gatefly/files/pictures.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/flight_log/flight_folder.hpp"
#include "gatefly/geometry/math.hpp"

#include "commands.hpp"

namespace gatefly::cli {
namespace {

namespace fs = std::filesystem;
using namespace calibration;
using io::fixed;
using io::number;

struct CalibrateOptions {
  CommonOptions common;
  std::vector<std::string> paths, zero;
  std::string out, from, to = "toml", model, camera, report, data, pattern, size, tilt_from;
  double square = 0.0;
  std::optional<double> gate_height;
  std::optional<int> rotate_deg;
  bool json = false;

  [[nodiscard]] int rotation() const { return rotate_deg.value_or(0); }
  [[nodiscard]] bool writes_to_stdout() const {
    return io::is_stdout(out) || io::is_stdout(report);
  }
};

void complain(const std::string& what) { std::cerr << "gatefly calibrate: " << what << '\n'; }

/// "9x6" as two numbers. @throws naming the flag.
Eigen::Vector2i pair_of(const std::string& text, const std::string& flag, int low, int high) {
  Eigen::Vector2i pair{0, 0};
  const char* const end = text.data() + text.size();
  const auto first = std::from_chars(text.data(), end, pair.x());
  if (first.ec == std::errc{} && first.ptr != end && *first.ptr == 'x') {
    const auto second = std::from_chars(first.ptr + 1, end, pair.y());
    if (second.ec == std::errc{} && second.ptr == end && pair.minCoeff() >= low &&
        pair.maxCoeff() <= high)
      return pair;
  }
  throw std::runtime_error(flag + " " + io::one_line(text) + ": must be two numbers in " +
                           std::to_string(low) + ".." + std::to_string(high) +
                           " with an x between them");
}

/// All that pictures and lists show of boards.
struct Boards {
  BoardViews views;
  Eigen::Vector2i size_px{0, 0};  ///< Upright.
  int pictures = 0, unusable = 0;
  bool listed = false;                                       ///< Some are from a corner list.
  std::vector<std::pair<std::string, std::string>> without;  ///< Picture, why it shows no board.
  std::map<std::string, int> other_patterns;                 ///< What is there instead, how often.
};

BoardPattern pattern_of(const CalibrateOptions& options) {
  if (options.pattern.empty())
    throw std::runtime_error(
        "--pattern is missing: inner corners of the checkerboard, 9x6 for one of 10x7 squares");
  if (!(options.square > 0.0))
    throw std::runtime_error("--square-m is missing: the side of one square in metres, 0.03");
  const Eigen::Vector2i size = pair_of(options.pattern, "--pattern", 3, 100);
  return {size.x(), size.y(), options.square};
}

void add_picture(const fs::path& path, const BoardPattern& pattern, int rotate_deg,
                 Boards& boards) {
  const io::ImageFile file = io::read_image(path);
  const Image image = file.view(rotate_deg);
  const Eigen::Vector2i size{image.width(), image.height()};
  if (boards.size_px.x() == 0) boards.size_px = size;
  if (size != boards.size_px)
    throw std::runtime_error(path.string() + ": is " + std::to_string(size.x()) + "x" +
                             std::to_string(size.y()) + ", must be " +
                             std::to_string(boards.size_px.x()) + "x" +
                             std::to_string(boards.size_px.y()) + " as the pictures before it");
  ++boards.pictures;
  const BoardSearch search = find_board(image, path.filename().string(), pattern);
  if (search.view)
    boards.views.push_back(*search.view);
  else
    boards.without.emplace_back(path.filename().string(), search.reason);
  if (search.other) ++boards.other_patterns[search.other->text()];
}

void add_list(const fs::path& path, const CalibrateOptions& options, Boards& boards) {
  if (options.size.empty())
    throw std::runtime_error(
        path.string() +
        ": corner lists do not know their picture's size: add --size WxH (of the stored picture)");
  Eigen::Vector2i size = pair_of(options.size, "--size", 16, 4096);
  BoardViews views = read_corner_list(path);
  for (const BoardView& view : views)
    for (const BoardCorner& corner : view.corners)
      if ((corner.px.array() < -0.5).any() ||
          (corner.px.array() > size.cast<double>().array() - 0.5).any())
        throw std::runtime_error(path.string() + ": " + view.image + " has a corner at (" +
                                 io::text_of(corner.px.x(), 6) + ", " +
                                 io::text_of(corner.px.y(), 6) + "), outside a picture of --size " +
                                 options.size);
  if (!options.pattern.empty()) {
    const Eigen::Vector2i pattern = pair_of(options.pattern, "--pattern", 3, 100);
    for (const BoardView& view : views)
      if (view.corners.size() != static_cast<std::size_t>(pattern.prod()))
        throw std::runtime_error(path.string() + ": " + view.image + " has " +
                                 std::to_string(view.corners.size()) + " corners, --pattern " +
                                 options.pattern + " has " + std::to_string(pattern.prod()));
  }
  turn_upright(views, size, options.rotation());
  if (options.rotation() % 180 != 0) std::swap(size.x(), size.y());
  if (boards.size_px.x() != 0 && size != boards.size_px)
    throw std::runtime_error(path.string() + ": --size " + options.size +
                             " is not the size of the pictures before it");
  boards.size_px = size;
  boards.listed = true;
  boards.pictures += static_cast<int>(views.size());
  boards.views.insert(boards.views.end(), std::make_move_iterator(views.begin()),
                      std::make_move_iterator(views.end()));
}

bool is_list(const fs::path& path) {
  return path.extension() == ".csv" || path.extension() == ".CSV";
}

std::vector<fs::path> all_files(const CalibrateOptions& options) {
  std::vector<fs::path> files;
  for (const std::string& path : options.paths)
    for (const fs::path& file : io::picture_files(io::find_data(path, options.data)))
      files.push_back(file);
  return files;
}

/// @throws when there are too few boards to start with, saying what the pictures show instead.
void refuse_without_boards(const Boards& boards, const CalibrateOptions& options) {
  int most = 0;
  std::string other;
  for (const auto& [pattern, count] : boards.other_patterns)
    if (count > most) {
      most = count;
      other = pattern;
    }
  const std::string all = std::to_string(boards.pictures);
  if (most > static_cast<int>(boards.views.size()))
    throw std::runtime_error("--pattern " + options.pattern + ": " + std::to_string(most) + " of " +
                             all + " pictures show a board of " + other +
                             " inner corners: --pattern " + other + "?");
  constexpr std::size_t kNeeded = 5;
  if (boards.views.size() >= kNeeded || boards.without.empty()) return;
  std::string reasons;
  for (std::size_t i = 0; i < std::min<std::size_t>(boards.without.size(), 3); ++i)
    reasons += "; " + boards.without[i].first + ": " + boards.without[i].second;
  throw std::runtime_error("a board in " + std::to_string(boards.views.size()) + " of " + all +
                           " pictures, at least " + std::to_string(kNeeded) + " are needed" +
                           reasons);
}

Boards find_boards(const CalibrateOptions& options) {
  Boards boards;
  const std::vector<fs::path> files = all_files(options);
  Progress progress(options.common.quiet, 10.0);
  std::optional<BoardPattern> pattern;
  double done = 0.0;
  for (const fs::path& file : files) {
    if (interrupted()) break;
    if (!is_list(file) && !pattern) pattern = pattern_of(options);
    if (is_list(file))
      add_list(file, options, boards);
    else
      try {
        add_picture(file, *pattern, options.rotation(), boards);
      } catch (const std::exception& error) {
        if (files.size() == 1) throw;
        progress.clear();
        complain(io::reason_of(error));
        ++boards.unusable;
      }
    ++done;
    if (progress.due(done))
      progress.update(done / static_cast<double>(files.size()),
                      io::amount(boards.views.size(), "board") + " in " +
                          io::amount(boards.pictures, "picture"));
  }
  progress.clear();
  if (!interrupted() && boards.pictures > 0) refuse_without_boards(boards, options);
  return boards;
}

/// "169.23 ± 0.02": as many digits as the sigma deserves.
std::string with_sigma(double value, double sigma) {
  const int digits =
      sigma > 0.0 ? std::clamp(static_cast<int>(std::ceil(-std::log10(sigma))) + 1, 0, 6) : 4;
  return fixed(value, digits) + (sigma > 0.0 ? " ± " + fixed(sigma, digits) : "");
}

void print_models(const Calibration& answer) {
  std::cout << std::left << std::setw(17) << "model" << std::right << std::setw(8) << "RMS px"
            << std::setw(13) << "held-out px"
            << "  parameters ± one standard deviation\n";
  for (std::size_t i = 0; i < answer.models.size(); ++i) {
    const ModelResult& result = answer.models[i];
    std::cout << std::left << std::setw(17)
              << (i == answer.recommended ? "* " : "  ") + name_of(result.fit.model) << std::right
              << std::setw(8) << fixed(result.rms_px, 3) << std::setw(13)
              << fixed(result.held_out_px, 3) << "  ";
    if (result.fit.sigma.size() == 0) {
      std::cout << "cannot be used: " << result.failure << '\n';
      continue;
    }
    const auto names = parameter_names(result.fit.model);
    for (std::size_t p = 0; p < names.size(); ++p) {
      const auto at = static_cast<Eigen::Index>(p);
      std::cout << (p > 0 ? ", " : "") << names[p] << ' '
                << with_sigma(result.fit.parameters[at],
                              result.fit.sigma.size() > at ? result.fit.sigma[at] : 0.0);
    }
    if (!result.failure.empty()) std::cout << "; not recommended: " << result.failure;
    std::cout << '\n';
  }
}

void print_views(const Calibration& answer, const Boards& boards) {
  std::size_t width = 7;
  for (const ViewResult& view : answer.views) width = std::max(width, view.image.size());
  const int name = static_cast<int>(width) + 2;
  std::cout << '\n'
            << std::left << std::setw(name) << "picture" << std::right
            << "corners  dropped  RMS px  max px\n";
  for (const ViewResult& view : answer.views) {
    std::cout << std::left << std::setw(name) << view.image << std::right << std::setw(7)
              << view.corners << std::setw(9) << view.dropped;
    if (view.reason.empty())
      std::cout << std::setw(8) << fixed(view.rms_px, 3) << std::setw(8) << fixed(view.max_px, 2)
                << '\n';
    else
      std::cout << "  left out: " << view.reason << '\n';
  }
  for (const auto& [image, reason] : boards.without)
    std::cout << std::left << std::setw(name) << image << std::right << std::setw(7) << 0
              << "           no board: " << reason << '\n';
}

/// What cannot be known about how the pictures are stored, one line; "" when it was said.
std::string rotation_warning(const Boards& boards, const CalibrateOptions& options,
                             std::optional<int> by_flight) {
  if (options.rotate_deg || by_flight) return "";
  if (boards.size_px.y() > boards.size_px.x())
    return "pictures of " + std::to_string(boards.size_px.x()) + "x" +
           std::to_string(boards.size_px.y()) +
           " stand on end: if the sensor is mounted turned, calibrate again with --rotate 90 (or "
           "270)";
  if (boards.listed)
    return "a corner list does not tell how pictures are stored, stored_rotation_deg = 0 is a "
           "guess: --rotate 90 if these are corners of turned "
           "pictures; if of upright ones, but the camera stores them turned, set "
           "stored_rotation_deg";
  return "";
}

void print(const Calibration& answer, const Boards& boards, const CalibrateOptions& options,
           const std::string& warning) {
  std::size_t corners = 0, dropped = 0;
  for (const ViewResult& view : answer.views) {
    corners += view.corners;
    dropped += view.dropped;
  }
  std::cout << io::amount(boards.pictures, "picture") << " of " << answer.size_px.x() << "x"
            << answer.size_px.y() << ", a board in " << answer.views.size() << ", "
            << answer.kept.size() << " of them used; " << corners << " corners, " << dropped
            << " dropped; they reach " << fixed(100.0 * answer.coverage, 0)
            << " % of the way to the picture's corners\n\n";
  print_models(answer);
  print_views(answer, boards);
  std::cout << "\n* recommended: the fewest parameters within one standard error of the best "
               "held-out residual\n";
  const std::string chosen = name_of(answer.best().fit.model);
  if (answer.chosen != answer.recommended) std::cout << "asked for: " << chosen << '\n';
  if (!answer.best().failure.empty())
    std::cout << "warning: " << chosen << ": " << answer.best().failure << '\n';
  if (answer.coverage < 0.7)
    std::cout << "warning: beyond the outermost corners the lens is extrapolated: hold the board "
                 "into the picture's corners too\n";
  if (!options.out.empty()) std::cout << options.out << ": " << chosen << '\n';
  if (!warning.empty()) std::cout << "warning: " << warning << '\n';
}

nlohmann::ordered_json as_json(const Calibration& answer, const Boards& boards,
                               int stored_rotation_deg, const std::string& warning) {
  nlohmann::ordered_json models = nlohmann::ordered_json::array(),
                         pictures = nlohmann::ordered_json::array();
  for (const ModelResult& result : answer.models) {
    nlohmann::ordered_json parameters = nlohmann::ordered_json::object();
    const auto names = parameter_names(result.fit.model);
    for (std::size_t p = 0; p < names.size(); ++p) {
      const auto at = static_cast<Eigen::Index>(p);
      parameters[names[p]] = {{"value", number(result.fit.parameters[at])},
                              {"sigma", result.fit.sigma.size() > at ? number(result.fit.sigma[at])
                                                                     : nlohmann::ordered_json()}};
    }
    models.push_back({{"model", name_of(result.fit.model)},
                      {"rms_px", number(result.rms_px)},
                      {"held_out_px", number(result.held_out_px)},
                      {"parameters", parameters},
                      {"failure", result.failure}});
  }
  for (const ViewResult& view : answer.views)
    pictures.push_back({{"image", view.image},
                        {"corners", view.corners},
                        {"dropped", view.dropped},
                        {"rms_px", view.rms_px},
                        {"max_px", view.max_px},
                        {"left_out", view.reason}});
  for (const auto& [image, reason] : boards.without)
    pictures.push_back({{"image", image}, {"corners", 0}, {"left_out", reason}});
  return {{"size_px", {answer.size_px.x(), answer.size_px.y()}},
          {"pictures", pictures},
          {"models", models},
          {"recommended", name_of(answer.models[answer.recommended].fit.model)},
          {"chosen", name_of(answer.best().fit.model)},
          {"coverage", answer.coverage},
          {"unusable", boards.unusable},
          {"stored_rotation_deg", stored_rotation_deg},
          {"stored_rotation_doubt", warning}};
}

CameraFormat format_of(const std::string& name) {
  return name == "kalibr" ? CameraFormat::kKalibr
         : name == "ros"  ? CameraFormat::kRos
                          : CameraFormat::kToml;
}

/// The lens with as many digits as anybody can measure.
AnyCamera short_lens(const LensFit& fit) {
  Eigen::VectorXd parameters = fit.parameters;
  constexpr int kDigits = 8;
  for (double& each : parameters) each = std::stod(io::text_of(each, kDigits));
  return lens_of(fit.model, parameters);
}

/// What the file says about its own making.
std::vector<std::string> provenance(const Calibration& answer) {
  const ModelResult& best = answer.best();
  std::vector<std::string> lines{"Made by gatefly calibrate from " +
                                 io::amount(answer.kept.size(), "picture") + " of a board: RMS " +
                                 fixed(best.rms_px, 3) + " px, " + fixed(best.held_out_px, 3) +
                                 " px in pictures held out."};
  std::string sigmas;
  const auto names = parameter_names(best.fit.model);
  for (std::size_t p = 0; p < names.size() && static_cast<Eigen::Index>(p) < best.fit.sigma.size();
       ++p)
    sigmas += (p > 0 ? ", " : "") + names[p] + " " +
              io::text_of(best.fit.sigma[static_cast<Eigen::Index>(p)], 2);
  if (!sigmas.empty()) lines.push_back("One standard deviation: " + sigmas + ".");
  return lines;
}

/// The camera and, of a calibration, the picture of its residuals.
void write(const CameraFile& camera, const CalibrateOptions& options,
           std::vector<std::string> comments, const Calibration* answer) {
  if (camera.stored_rotation_deg != 0 && options.to != "toml")
    comments.push_back("Of the upright picture: the stored one turned " +
                       std::to_string(camera.stored_rotation_deg) + " degrees counter-clockwise.");
  const std::string text = camera_text(camera, format_of(options.to), comments);
  std::vector<io::FileContent> files;
  if (!options.out.empty()) files.push_back({options.out, text});
  if (answer != nullptr && !options.report.empty())
    files.push_back({options.report, residual_picture(*answer).png()});
  io::write_files(files);
}

/// The first gate of each picture, where it has exactly one.
std::vector<Quad> single_gates(const io::Labels& labels) {
  std::vector<Quad> gates;
  for (const io::LabelledPicture& picture : labels.pictures)
    if (picture.gates.size() == 1) gates.push_back(picture.gates[0]);
  return gates;
}

/// How a flight's pictures must be turned for its gates to be found where its labels (upright) have
/// them; nullopt when no way stands out.
std::optional<int> stored_rotation_of(const fs::path& flight, const Eigen::Vector2i& upright_px,
                                      const io::Config& config) {
  constexpr double kSamePx = 10.0;
  constexpr std::size_t kPictures = 20;
  const io::Labels labels = io::read_labels(flight / "labels.csv");
  const auto detector = std::make_unique<GateDetector>(config.pilot.detector);
  std::map<int, int> hits;
  std::size_t pictures = 0;
  for (const io::LabelledPicture& picture : labels.pictures) {
    if (picture.gates.size() != 1 || !fs::exists(flight / picture.image) || ++pictures > kPictures)
      continue;
    const io::ImageFile file = io::read_image(flight / picture.image);
    for (const int turn : {0, 90, 180, 270}) {
      const Image image = file.view(turn);
      if (Eigen::Vector2i{image.width(), image.height()} != upright_px) continue;
      const auto found = detector->look(image, config.pilot.gate_color).gates;
      if (!found.empty() &&
          (center(found[0].corners_px) - center(picture.gates[0])).norm() < kSamePx)
        ++hits[turn];
    }
  }
  for (const auto& [turn, count] : hits)
    if (count >= 3 && std::none_of(hits.begin(), hits.end(), [&](const auto& other) {
          return other.first != turn && 2 * other.second > count;
        }))
      return turn;
  return std::nullopt;
}

/// Adds the mount angle to the camera, and what it rests on to the comments.
void add_tilt(CameraFile& camera, const CalibrateOptions& options,
              std::vector<std::string>& comments) {
  if (options.tilt_from.empty()) return;
  const io::Config config = load(options.common);
  const fs::path path = io::find_data(options.tilt_from, options.data);
  const bool flight = fs::is_directory(path);
  const io::Labels labels = io::read_labels(flight ? path / "labels.csv" : path);
  Mount mount;
  try {
    mount = flight ? mount_from_flight(io::read_flight_folder(path), labels, camera.lens,
                                       config.gate.side, config.camera.p_BC)
                   : mount_from_level(single_gates(labels), camera.lens, config.gate.side,
                                      options.gate_height);
  } catch (const std::exception& error) {
    throw std::runtime_error("--tilt-from " + options.tilt_from + ": " + error.what());
  }
  camera.tilt_down = mount.tilt_down;
  comments.push_back(
      "Tilt " + with_sigma(mount.tilt_down / kDegree, mount.tilt_sigma / kDegree) +
      " deg down, roll " + with_sigma(mount.roll / kDegree, mount.roll_sigma / kDegree) +
      " deg, from " + io::amount(mount.pictures, "picture") + " of a gate (" +
      path.filename().string() + "), RMS " + fixed(mount.rms_px, 2) + " px" +
      (flight ? "; fitted with it: heading offset " + fixed(mount.heading_offset / kDegree, 1) +
                    " deg, pictures " + fixed(1e3 * mount.time_offset, 0) + " ms, gate at (" +
                    fixed(mount.p_EG.x(), 2) + ", " + fixed(mount.p_EG.y(), 2) + ", " +
                    fixed(mount.p_EG.z(), 2) + ") m."
              : "; a drone that stood askew by a degree makes it a degree."));
  if (!options.json && !options.common.quiet && !options.writes_to_stdout())
    std::cout << comments.back() << '\n';
}

int convert(const CalibrateOptions& options) {
  if (!options.paths.empty())
    throw std::runtime_error("--from " + options.from +
                             ": takes the camera from that file, no pictures besides");
  if (options.out.empty())
    throw std::runtime_error("--from " + options.from +
                             ": --out is missing: where to (- for stdout)");
  const fs::path path = io::find_data(options.from, options.data);
  CameraFile camera = read_camera(path, options.camera);
  std::vector<std::string> comments{"From " + path.filename().string() + " by gatefly calibrate."};
  add_tilt(camera, options, comments);
  write(camera, options, comments, nullptr);
  return kDone;
}

/// gatefly calibrate: exit 0 done, 2 no camera comes out (or, at the end, a picture could not be
/// read), 130 Ctrl-C.
int run_calibrate(const CalibrateOptions& options) {
  std::vector<fs::path> inputs = all_files(options);
  for (const std::string& input : {options.from, options.tilt_from})
    if (!input.empty()) inputs.push_back(io::find_data(input, options.data));
  check_outputs({{"--out", options.out, {"camera of gatefly calibrate", "by gatefly calibrate"}},
                 {"--report", options.report, io::kOurPng}},
                inputs, options.common);
  if (!options.from.empty()) return convert(options);
  if (options.paths.empty())
    throw std::runtime_error(
        "neither pictures nor a corner list nor --from is given (--help shows an example)");
  if (options.writes_to_stdout() && options.json)
    throw std::runtime_error("--json and --out or --report -: both want stdout; name a file");

  catch_interrupt();
  const Boards boards = find_boards(options);
  if (interrupted()) {
    complain("interrupted, nothing written");
    return kInterrupted;
  }
  if (boards.pictures == 0) return kUnusable;  // each was said
  CalibrationOptions how;
  how.model = lens_model(options.model);
  how.zero = options.zero;
  const Calibration answer = calibration::calibrate(boards.views, boards.size_px, how);
  std::vector<std::string> comments = provenance(answer);
  std::optional<int> by_flight;
  const fs::path flight =
      options.tilt_from.empty() ? fs::path{} : io::find_data(options.tilt_from, options.data);
  if (boards.listed && !options.rotate_deg && fs::is_directory(flight))
    by_flight = stored_rotation_of(flight, answer.size_px, load(options.common));
  if (by_flight)
    comments.push_back("stored_rotation_deg: so the gates of " + flight.filename().string() +
                       " are where its labels have them.");
  CameraFile camera{
      short_lens(answer.best().fit), answer.size_px, by_flight.value_or(options.rotation()), {}};
  const std::string warning = rotation_warning(boards, options, by_flight);
  if (!warning.empty()) comments.push_back("Beware: " + warning + ".");
  add_tilt(camera, options, comments);
  write(camera, options, comments, &answer);
  if (options.json)
    std::cout << as_json(answer, boards, camera.stored_rotation_deg, warning).dump(2) << '\n';
  else if (!options.common.quiet && !options.writes_to_stdout())
    print(answer, boards, options, warning);
  if (boards.unusable == 0) return kDone;
  complain(io::amount(boards.unusable, "picture") + " could not be used, the rest was");
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
  Flag pattern = command.option("--pattern", options->pattern, "inner corners of the checkerboard")
                     .type_name("COLUMNSxROWS");
  Flag square = command.option("--square-m", options->square, "side of a square")
                    .between(1e-4, 10.0)
                    .type_name("METRES");
  Flag size = command.option("--size", options->size, "of the stored pictures behind a corner list")
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
  command.runs([options] { return run_calibrate(*options); });
}

}  // namespace gatefly::cli
