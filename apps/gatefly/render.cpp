// SPDX-License-Identifier: Apache-2.0
#include <atomic>
#include <exception>
#include <filesystem>
#include <iostream>
#include <limits>
#include <memory>
#include <mutex>
#include <regex>
#include <string>
#include <thread>
#include <vector>

#include "gatefly/config/config.hpp"
#include "gatefly/files/image_file.hpp"
#include "gatefly/files/jpeg_writer.hpp"
#include "gatefly/files/json.hpp"
#include "gatefly/files/partial_folder.hpp"
#include "gatefly/files/png_writer.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/sim/body_state.hpp"
#include "gatefly/simulated_race/labelled_pictures.hpp"
#include "gatefly/simulated_race/varied_look.hpp"

#include "commands.hpp"
#include "drone_options.hpp"

namespace gatefly::cli {
namespace {

namespace fs = std::filesystem;

struct RenderOptions {
  CommonOptions common;
  DroneOptions drone;
  std::string track = "showroom", recording = "jpeg", out;
  int frames = 0, per_seed = 40, jobs = 0;
  double around = 30.0;
  std::uint64_t seed = 1;
  bool masks = false, varied = false, fast = false, json = false;
};

bool is_ours(const std::string& name) {
  static const std::regex kNames{
      "img_[0-9]+\\.(jpg|png)|mask_[0-9]+\\.pgm|labels\\.csv|gates\\.csv|poses\\.csv|render\\."
      "json"};
  return std::regex_match(name, kNames);
}

/// How a picture is turned and written so that `detect` finds it upright.
struct Storing {
  int rotation_deg = 90;  ///< Turn that makes a stored picture upright, counter-clockwise.
  bool said_by_exif = true;
};

Storing storing_of(const CommonOptions& options, const std::string& recording) {
  const config::Config config = tasks::load(options);
  const bool named = config.set_by.contains("camera.stored_rotation_deg");
  if (!named && recording == "raw") return {0, false};  // a PNG says nothing
  return {config.camera.stored_rotation_deg, !named};
}

int exif_of(int rotation_deg) {
  for (int orientation = 1; orientation <= 8; ++orientation)
    if (files::exif_rotation_deg(orientation) == rotation_deg) return orientation;
  return 0;
}

std::string padded(std::size_t number) {
  const std::string text = std::to_string(number);
  return std::string(text.size() < 5 ? 5 - text.size() : 0, '0') + text;
}

/// A grey picture that `detect` takes for none of its own.
std::string pgm_of(const std::vector<std::uint8_t>& pixels, int width, int height) {
  return "P5\n" + std::to_string(width) + " " + std::to_string(height) + "\n255\n" +
         std::string(pixels.begin(), pixels.end());
}

std::string corners_text(const sim::GateView& gate) {
  std::string text;
  for (const Eigen::Vector2d& corner : gate.corners_px)
    text += "," + files::fixed(corner.x(), 2) + "," + files::fixed(corner.y(), 2);
  return text;
}

/// Rows of the tables, picture by picture.
struct Rows {
  std::string labels, gates, poses;
};

Rows rows_of(const simulated_race::Picture& picture, const std::string& name) {
  Rows rows;
  for (const sim::GateView& gate : picture.gates) {
    if (gate.whole) rows.labels += name + ",1" + corners_text(gate) + "\n";
    rows.gates += name + "," + std::to_string(gate.gate + 1) + "," +
                  files::fixed(gate.distance, 3) + (gate.whole ? ",1" : ",0");
    for (const bool seen : gate.seen) rows.gates += seen ? ",1" : ",0";
    rows.gates += corners_text(gate) + "\n";
  }
  if (rows.labels.empty()) rows.labels = name + ",0,,,,,,,,\n";
  const Attitude a = attitude_of({sim::R_EB_of(picture.pose.q_EB.normalized())});
  const Eigen::Vector3d& p = picture.pose.p_EB;
  rows.poses = name + "," + std::to_string(picture.seed) + (picture.around ? ",around" : ",race");
  for (const double x : {p.x(), p.y(), p.z()}) rows.poses += "," + files::fixed(x, 4);
  for (const double x : {a.roll, a.pitch, a.yaw}) rows.poses += "," + files::fixed(x / kDegree, 3);
  rows.poses += "\n";
  return rows;
}

/// Renders seeds on several threads into a folder.
class Studio {
 public:
  Studio(const simulated_race::RaceMaker& maker, const simulated_race::PictureOrder& order,
         const files::PartialFolder& folder, const RenderOptions& options)
      : maker_{maker},
        order_{order},
        folder_{folder},
        recording_{options.recording},
        storing_{storing_of(options.common, options.recording)},
        rows_(order.pictures) {}

  /// @throws whatever a worker threw, Interrupted after Ctrl-C.
  void work(int jobs, bool quiet) {
    std::vector<std::thread> workers;
    for (int i = 0; i < jobs; ++i) workers.emplace_back([this] { seeds(); });
    Progress progress(quiet, 200.0);
    while (ended_ < jobs) {
      std::this_thread::sleep_for(std::chrono::milliseconds{100});
      const auto done = static_cast<double>(done_);
      if (progress.due(done))
        progress.update(
            done / static_cast<double>(order_.pictures),
            std::to_string(done_) + " of " + std::to_string(order_.pictures) + " pictures");
    }
    for (std::thread& worker : workers) worker.join();
    progress.clear();
    if (error_) std::rethrow_exception(error_);
    if (done_ < order_.pictures) throw Interrupted{};  // between two seeds
  }

  [[nodiscard]] Rows rows() const {
    constexpr const char* kCorners = "tl_u,tl_v,tr_u,tr_v,br_u,br_v,bl_u,bl_v\n";
    Rows all{std::string{"image,has_gate,"} + kCorners,
             std::string{"image,gate,distance_m,whole,tl_seen,tr_seen,br_seen,bl_seen,"} + kCorners,
             "image,seed,pose,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\n"};
    for (const Rows& each : rows_)
      all.labels += each.labels, all.gates += each.gates, all.poses += each.poses;
    return all;
  }

 private:
  void seeds() {
    try {
      const std::size_t count = simulated_race::seeds_of(order_);
      for (std::size_t nth = next_++; nth < count && !stop_ && !interrupted(); nth = next_++)
        simulated_race::render_seed(
            maker_, order_, nth,
            [&](simulated_race::Picture&& picture) {
              keep(picture);
              return true;
            },
            [this] {
              if (stop_ || interrupted()) throw Interrupted{};
            });
    } catch (...) {
      const std::lock_guard lock{mutex_};
      if (!error_) error_ = std::current_exception();
      stop_ = true;
    }
    ++ended_;
  }

  void keep(const simulated_race::Picture& picture) {
    const simulated_race::Race& race = nominal_;
    const world::CameraTruth& camera = race.config.sim.camera;
    const int turn = (camera.stored_rotation - storing_.rotation_deg + 360) % 360;
    const Image stored{picture.uyvy.data(), PixelFormat::kUyvy, camera.stored_width,
                       camera.stored_height, turn};
    const std::string number = padded(picture.number);
    const std::string name = "img_" + number + (recording_ == "raw" ? ".png" : ".jpg");
    if (recording_ == "raw") {
      folder_.write(name, files::png_of(stored));
    } else {
      const bool careful =
          recording_ == "jpeg" ||
          (recording_ == "varied" &&
           simulated_race::varied_recording(picture.seed) == simulated_race::Stored::kJpeg);
      const auto how = careful ? files::Recording::kJpeg : files::Recording::kMjpegLow;
      const int exif = storing_.said_by_exif ? exif_of(storing_.rotation_deg) : 0;
      folder_.write(name, files::recorded_jpeg(stored, how, exif));
    }
    if (!picture.mask.empty())
      folder_.write("mask_" + number + ".pgm",
                    pgm_of(picture.mask, camera.width(), camera.height()));
    rows_[picture.number] = rows_of(picture, name);
    ++done_;
  }

  const simulated_race::RaceMaker& maker_;
  simulated_race::PictureOrder order_;
  const files::PartialFolder& folder_;
  std::string recording_;
  Storing storing_;
  simulated_race::Race nominal_ = maker_.race(order_.first_seed);
  std::vector<Rows> rows_;
  std::atomic<std::size_t> next_{0}, done_{0};
  std::atomic<int> ended_{0};  ///< Threads that have nothing left to do.
  std::atomic<bool> stop_{false};
  std::mutex mutex_;
  std::exception_ptr error_;
};

int render(const RenderOptions& options) {
  if (options.frames < 1)
    throw std::runtime_error("--frames: how many? (a whole number, 1 or more)");
  const fs::path out =
      options.out.empty()
          ? fs::path{"out"} / ("pictures-" + fs::path{options.track}.stem().string())
          : fs::path{options.out};
  files::check_output_folder("--out", out);
  files::refuse_foreign_folder(out, "render.json", {"pictures", "\"recording\""},
                               "choose another --out");
  const auto later_seeds = static_cast<std::uint64_t>((options.frames - 1) / options.per_seed);
  if (options.seed > std::numeric_limits<std::uint64_t>::max() - later_seeds)
    throw std::runtime_error("--seed " + std::to_string(options.seed) + ": " +
                             std::to_string(later_seeds + 1) +
                             " worlds from there on have no seeds");
  tasks::ConfigArguments config = options.common;
  if (options.varied) config.settings.insert(config.settings.begin(), "randomize.level=hard");
  if (options.fast) config.settings.push_back("sim.camera_quality=fast");
  const simulated_race::RaceMaker maker(
      {.config = config, .track = options.track, .vision = "rendered", .laps = std::nullopt});
  say_notes(maker.notes());
  const simulated_race::PictureOrder order{.pictures = static_cast<std::size_t>(options.frames),
                                           .per_seed = static_cast<std::size_t>(options.per_seed),
                                           .first_seed = options.seed,
                                           .around = 0.01 * options.around,
                                           .varied = options.varied,
                                           .masks = options.masks};
  catch_interrupt();
  files::PartialFolder folder(out, files::PartialFolder::Grows::kBeside, is_ours);
  Studio studio(maker, order, folder, options);
  const int cores = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  studio.work(options.jobs > 0 ? options.jobs : cores, options.common.quiet);
  const Rows rows = studio.rows();
  folder.write("labels.csv", rows.labels);
  folder.write("gates.csv", rows.gates);
  folder.write("poses.csv", rows.poses);
  const simulated_race::Race race = maker.race(options.seed);
  const nlohmann::ordered_json said{
      {"track", race.identity.track},   {"frames", options.frames},
      {"recording", options.recording}, {"seed", options.seed},
      {"per_day", options.per_seed},    {"around_percent", options.around},
      {"varied", options.varied},       {"fast", options.fast},
      {"masks", options.masks},         {"version", race.identity.version},
      {"commit", race.identity.commit}, {"config", race.identity.config}};
  folder.write("render.json", files::json_text(said));
  folder.replace([](const std::string&) { return false; });
  if (options.json) {
    std::cout << files::json_text(said);
    return kDone;
  }
  std::cout << files::amount(order.pictures, "picture") << " of " << race.identity.track << ", "
            << files::amount(simulated_race::seeds_of(order), "seed") << ": " << (out / "").string()
            << '\n';
  return kDone;
}

}  // namespace

void declare_render(Command& command) {
  auto options = std::make_shared<RenderOptions>();
  command.footer(
      "Example:\n  gatefly render showroom --frames 200 --out out/pictures\n"
      "  gatefly detect out/pictures --csv found.csv\n"
      "  gatefly score --detections found.csv --labels out/pictures/labels.csv\n\n"
      "labels.csv: the whole gates in view, upright, nearest first; gates.csv: all in view, which "
      "corners are seen;\nposes.csv: where the drone was; mask_*.pgm: which gate's frame a pixel "
      "shows.");
  command.option("TRACK", options->track, "a name in tracks/ or a file").show_default();
  command.option("--frames", options->frames, "how many pictures").between(1, 1000000);
  command.option("--seed", options->seed, "the first; each seed has its own world and light")
      .show_default();
  command.option("--per-day", options->per_seed, "pictures of one seed")
      .between(1, 100000)
      .show_default();
  command
      .option("--around", options->around,
              "percent from anywhere in the room, the others from races")
      .between(0.0, 100.0)
      .show_default();
  command
      .option("--recording", options->recording,
              "raw: PNG; jpeg: as careful as the authors' picked ones; mjpeg-low: as their video; "
              "varied: "
              "jpeg or mjpeg-low, by the seed")
      .one_of({"raw", "jpeg", "mjpeg-low", "varied"})
      .show_default();
  command.flag("--masks", options->masks, "a mask beside each picture");
  command.flag(
      "--varied", options->varied,
      "domain randomisation, for training: with each seed other lamps, surfaces, gates, clutter, "
      "camera and sensor");
  command.flag("--fast", options->fast,
               "one ray a pixel, no blur or glare: sim.camera_quality=fast");
  command.option("--jobs", options->jobs, "threads [one a core]").between(1, 1024);
  command.flag("--json", options->json, "print render.json");
  command.option("--out", options->out, "folder [out/pictures-TRACK]").path("DIR");
  add_drone(command, options->drone);
  add_speed(command, options->drone);
  add_common(command, options->common);
  command.runs([options] {
    take_drone(options->drone, options->common);
    return render(*options);
  });
}

}  // namespace gatefly::cli
