// SPDX-License-Identifier: Apache-2.0
#include "gatefly/tasks/tuning/tune.hpp"

#include <algorithm>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <map>
#include <memory>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <unordered_set>

#include <nlohmann/json.hpp>

#include "gatefly/config/derived.hpp"
#include "gatefly/drawing/plot.hpp"
#include "gatefly/files/color_model_file.hpp"
#include "gatefly/files/csv.hpp"
#include "gatefly/files/image_file.hpp"
#include "gatefly/files/json.hpp"
#include "gatefly/files/labels_file.hpp"
#include "gatefly/files/pictures.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/tasks/tuning/describe.hpp"
#include "gatefly/tasks/upright.hpp"

#include "commands.hpp"

namespace gatefly::cli {
namespace {

namespace fs = std::filesystem;
using tuning::Tuned;

struct TuneOptions {
  CommonOptions common;
  std::vector<std::string> images;
  std::string labels, ignore, describe, out, data;
  std::optional<int> rotate_deg;
  double false_per_image = 0.02;
  bool json = false;
};

/// The pictures that are fitted to, and what was left out.
struct Material {
  std::vector<files::ImageFile> files;  ///< Behind the pictures.
  std::vector<tuning::LabelledImage> pictures;
  int unusable = 0, duplicates = 0, without_label = 0, labels_without_picture = 0;

  /// "10 of 640x480 px, 2 of 315x160 px"; "" where all have one size.
  [[nodiscard]] std::string sizes() const {
    std::map<std::string, int> count;
    for (const tuning::LabelledImage& picture : pictures)
      ++count[std::to_string(picture.image.width()) + "x" + std::to_string(picture.image.height()) +
              " px"];
    if (count.size() < 2) return "";
    std::vector<std::string> parts;
    for (const auto& [size, number] : count)
      parts.push_back(std::to_string(number) + " of " + size);
    return files::joined(parts);
  }
};

void complain(const std::string& what) { std::cerr << "gatefly tune: " << what << '\n'; }

std::vector<fs::path> all_files(const TuneOptions& options) {
  std::vector<fs::path> files;
  for (const std::string& path : options.images) {
    const fs::path found = data_at(path, options.data);
    for (const fs::path& file : files::picture_files(found)) files.push_back(file);
    if (const std::string others = files::left_out_of(found); !others.empty()) complain(others);
  }
  // Neighbours in time stay in one half.
  std::stable_sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) {
    return a.parent_path() != b.parent_path()
               ? a.parent_path() < b.parent_path()
               : files::counts_before(a.filename().string(), b.filename().string());
  });
  return files;
}

std::map<std::string, std::vector<Quad>> gates_by_picture(const files::Labels& labels) {
  std::map<std::string, std::vector<Quad>> gates;
  for (const files::LabelledPicture& picture : labels.pictures)
    gates[picture.image] = picture.gates;
  return gates;
}

/// Reads every picture that has a label, or every one without --labels; identical ones once.
Material gathered(const TuneOptions& options, const config::Config& config, Progress& progress) {
  Material material;
  const bool labelled = !options.labels.empty();
  std::map<std::string, std::vector<Quad>> gates, ignored;
  if (labelled) gates = gates_by_picture(files::read_labels(data_at(options.labels, options.data)));
  if (!options.ignore.empty())
    ignored = gates_by_picture(files::read_labels(data_at(options.ignore, options.data)));
  std::unordered_set<std::string> contents, names;
  const std::vector<fs::path> files = all_files(options);
  tasks::Upright upright(config);
  for (const fs::path& path : files) {
    if (interrupted()) break;
    const std::string name = path.filename().string();
    if (labelled && !gates.contains(name)) {
      ++material.without_label;
      continue;
    }
    names.insert(name);
    try {
      files::ImageFile file =
          files::read_image(path, config.camera.stored_width(), config.camera.stored_height());
      if (!contents.emplace(file.bytes.begin(), file.bytes.end()).second) {
        ++material.duplicates;
        continue;
      }
      const Image image = upright.view(file, path);  // its bytes stay where they are
      material.files.push_back(std::move(file));
      material.pictures.push_back(
          {.image = image,
           .truth = {.gates = gates[name], .ignored = ignored[name], .detections = {}}});
    } catch (const std::exception& error) {
      progress.clear();
      complain(files::reason_of(error));
      ++material.unusable;
    }
    const auto done = static_cast<double>(names.size());
    if (progress.due(done))
      progress.update(0.5 * done / static_cast<double>(files.size()),
                      files::amount(names.size(), "picture") + " read");
  }
  progress.clear();
  if (!material.files.empty() && !options.common.quiet) complain(upright.said());
  if (const std::string sizes = material.sizes(); !sizes.empty() && !options.common.quiet)
    complain("pictures of several sizes, " + sizes + ": one camera's colours are learnt best");
  if (labelled)
    material.labels_without_picture =
        static_cast<int>(gates.size()) - static_cast<int>(names.size());
  if (labelled && names.empty() && !files.empty())
    throw std::runtime_error(options.labels + ": names none of the " +
                             files::amount(files.size(), "picture") + ", e.g. " +
                             files.front().filename().string());
  return material;
}

constexpr const char *kColors = ".colors.toml", *kRocTable = ".roc.csv", *kRocPlot = ".roc.png";

/// mine.toml -> mine.colors.toml, mine.roc.csv, mine.roc.png.
fs::path beside(const fs::path& out, const char* ending) {
  return out.parent_path() / (out.stem().string() + ending);
}

std::string summary_of(const TuneOptions& options, const Material& material, const Tuned& tuned) {
  const std::string pictures = files::amount(material.pictures.size(), "picture") + ", ";
  return options.labels.empty()
             ? pictures + std::to_string(tuned.gates) + " detections of fitness " +
                   files::text_of(tuned.confident) + " and more"
             : pictures + files::amount(tuned.gates, "labelled gate");
}

std::string rates_of(const tuning::Operating& point) {
  return "hit rate " + files::fixed(point.true_positive_rate, 3) + ", " +
         files::fixed(point.false_per_image, 3) + " false per picture";
}

/// The lens that the gates show, in words; "" where a lens was named.
std::string words_of(const tuning::GateLens& lens, const config::Config& config) {
  using Says = tuning::GateLens::Says;
  if (config.pilot.detector.lens.model) return "";
  const auto degrees = [](double angle) { return files::fixed(angle / kDegree, 1); };
  const std::string gates = files::amount(lens.gates, "gate");
  if (lens.says == Says::kBent)
    return "bends bars as an equidistant one of " + degrees(lens.angle) + " ± " +
           degrees(lens.angle_sigma) + "° across the picture, by " +
           files::amount(lens.sides, "side") + " of " + gates +
           (lens.knows_center
                ? "; its centre is " + files::fixed(100.0 * lens.center.x(), 1) + ", " +
                      files::fixed(100.0 * lens.center.y(), 1) + " % of the width off the middle"
                : "; its centre taken as the picture's middle");
  if (lens.says == Says::kStraight)
    return "straight: " + gates + " leave no more than " + degrees(lens.widest) + "°";
  return "cannot be told from " + gates + "; bars are taken for straight";
}

std::string lens_text(const tuning::GateLens& lens, const config::Config& config) {
  if (lens.says == tuning::GateLens::Says::kNothing || config.pilot.detector.lens.model) return "";
  std::string text = "lens_deg = " + files::text_of(lens.angle / kDegree, 4) + "  # " +
                     words_of(lens, config) +
                     "\n# for finding gates; distances need gatefly "
                     "calibrate, whose lens goes before this one\n";
  if (lens.knows_center)
    text += "lens_center = [" + files::text_of(lens.center.x(), 3) + ", " +
            files::text_of(lens.center.y(), 3) + "]\n";
  return text;
}

std::string config_text(const TuneOptions& options, const config::Config& config,
                        const Material& material, const Tuned& tuned) {
  std::ostringstream text;
  text << "# Written by gatefly tune: " << summary_of(options, material, tuned) << ".\n";
  if (options.rotate_deg)
    text << "[camera]\nstored_rotation_deg = " << *options.rotate_deg << "\n\n";
  text << "[color]\nrgb = [" << files::text_of(config.gate.rgb.x(), 4) << ", "
       << files::text_of(config.gate.rgb.y(), 4) << ", " << files::text_of(config.gate.rgb.z(), 4)
       << "]\n";
  if (!tuned.learnt) return text.str();
  text << "table = " << nlohmann::json(beside(options.out, kColors).filename().string()).dump()
       << "\n\n[detector]\n"
       << lens_text(tuned.lens, config)
       << "min_score = " << files::text_of(tuned.chosen.min_score, 4) << "  # "
       << (options.labels.empty() ? "estimated without labels: " : "two-fold: ")
       << rates_of(tuned.chosen) << "\nsure_score = "
       << files::text_of(
              tuning::with_fitted_colors({.detector = config.pilot.detector}).detector.sure_score,
              4)
       << "  # fitted colours give higher scores than described ones\n";
  return text.str();
}

std::string roc_text(const tuning::Roc& roc) {
  std::string text = "min_score,true_positive_rate,false_positives_per_image\n";
  for (const tuning::Operating& point : roc.points)
    text += files::text_of(point.min_score, 6) + "," + files::text_of(point.true_positive_rate, 6) +
            "," + files::text_of(point.false_per_image, 6) + "\n";
  return text;
}

/// Without labels hits are of what was found: over false positives that is a flat line.
drawing::Canvas estimate_plot(const Tuned& tuned) {
  drawing::PlotSeries hits{.name = "hit rate, estimated"},
      wrong{.name = "false positives per picture, estimated", .color = drawing::kLight.flown},
      chosen{.name = "detector.min_score = " + files::text_of(tuned.chosen.min_score, 3),
             .points = {{tuned.chosen.min_score, 0.0}, {tuned.chosen.min_score, 1.0}},
             .color = drawing::kLight.gate_solid,
             .marks = false};
  hits.marks = wrong.marks = false;
  for (const tuning::Operating& point : tuned.roc.points) {
    hits.points.emplace_back(point.min_score, point.true_positive_rate);
    wrong.points.emplace_back(point.min_score, point.false_per_image);
  }
  return drawing::draw({.title = "Estimated without labels",
                        .x_label = "detector.min_score",
                        .y_label = "rate",
                        .series = {hits, wrong, chosen}});
}

drawing::Canvas roc_plot(const Tuned& tuned) {
  drawing::PlotSeries curve{.name = "each half by the other's colours"};
  for (const tuning::Operating& point : tuned.roc.points)
    curve.points.emplace_back(point.false_per_image, point.true_positive_rate);
  drawing::PlotSeries chosen{
      .name = "min_score " + files::text_of(tuned.chosen.min_score, 3),
      .points = {{tuned.chosen.false_per_image, tuned.chosen.true_positive_rate}},
      .color = drawing::kLight.gate_solid,
      .line = false,
      .rings = true};
  return drawing::draw({.title = "Hits and false positives over detector.min_score",
                        .x_label = "false positives per picture",
                        .y_label = "true positive rate",
                        .series = {curve, chosen}});
}

/// The configuration last: when it is there, so is all that it names.
void write(const TuneOptions& options, const config::Config& config, const Material& material,
           const Tuned& tuned) {
  std::vector<files::FileContent> files;
  if (tuned.learnt)
    files = {{beside(options.out, kColors),
              files::color_model_text(tuned.color, summary_of(options, material, tuned))},
             {beside(options.out, kRocTable), roc_text(tuned.roc)},
             {beside(options.out, kRocPlot),
              (options.labels.empty() ? estimate_plot(tuned) : roc_plot(tuned)).png()}};
  files.push_back({options.out, config_text(options, config, material, tuned)});
  files::write_files(files);
}

/// Before the work: whether all that write() will write, may be.
void check_outputs_of(const TuneOptions& options, const config::Config& config) {
  if (options.out == "-" || (fs::exists(options.out) && fs::is_other(options.out)))
    throw std::runtime_error("--out " + options.out +
                             ": must be the name of a file, three others are written beside it");
  std::vector<fs::path> inputs;
  for (const std::string& image : options.images) inputs.push_back(data_at(image, options.data));
  for (const std::string& input : {options.labels, options.ignore, config.gate.color_table})
    if (!input.empty()) inputs.push_back(data_at(input, options.data));
  const files::OutputKind ours{"configuration of gatefly tune", "by gatefly tune"};
  check_outputs({{"--out", options.out, ours},
                 {"--out", beside(options.out, kColors), ours},
                 {"--out",
                  beside(options.out, kRocTable),
                  {"ROC of gatefly tune", "min_score,true_positive_rate,"}},
                 {"--out", beside(options.out, kRocPlot), files::kOurPng}},
                inputs, options.common);
}

nlohmann::ordered_json as_json(const tuning::GateLens& lens, const config::Config& config) {
  using Says = tuning::GateLens::Says;
  if (config.pilot.detector.lens.model) return {{"says", "named"}};
  nlohmann::ordered_json json{{"says", lens.says == Says::kBent       ? "bent"
                                       : lens.says == Says::kStraight ? "straight"
                                                                      : "unknown"},
                              {"gates", lens.gates},
                              {"sides", lens.sides}};
  if (lens.says != Says::kNothing) json["widest_deg"] = lens.widest / kDegree;
  if (lens.says != Says::kBent) return json;
  json["angle_deg"] = lens.angle / kDegree, json["angle_sigma_deg"] = lens.angle_sigma / kDegree;
  json["center"] = lens.knows_center ? nlohmann::ordered_json{lens.center.x(), lens.center.y()}
                                     : nlohmann::ordered_json(nullptr);
  return json;
}

nlohmann::ordered_json as_json(const TuneOptions& options, const Material& material,
                               const config::Config& config, const Tuned& tuned) {
  return {{"pictures", material.pictures.size()},
          {options.labels.empty() ? "confident_detections" : "labelled_gates", tuned.gates},
          {"learnt", tuned.learnt},
          {"estimated", options.labels.empty()},
          {"min_score", tuned.chosen.min_score},
          {"true_positive_rate", tuned.chosen.true_positive_rate},
          {"false_positives_per_image", tuned.chosen.false_per_image},
          {"lens", as_json(tuned.lens, config)},
          {"left_out",
           {{"unusable", material.unusable},
            {"duplicates", material.duplicates},
            {"without_label", material.without_label},
            {"labels_without_picture", material.labels_without_picture}}},
          {"config", options.out}};
}

void print_screen(const TuneOptions& options, const Material& material,
                  const config::Config& config, const Tuned& tuned) {
  const auto line = [](const char* name, const std::string& text) {
    std::cout << "  " << std::left << std::setw(14) << name << text << '\n';
  };
  std::cout << summary_of(options, material, tuned) << '\n';
  if (options.common.quiet) return;
  if (tuned.learnt) {
    double before = -1.0;
    for (const double allowed : {0.01, 0.02, 0.05, 0.1}) {
      const tuning::Operating point = tuned.roc.at(allowed);
      if (point.min_score == before) continue;  // of few pictures many are the same
      line(before < 0.0 ? (options.labels.empty() ? "estimated" : "two-fold") : "",
           rates_of(point) + " (min_score " + files::text_of(point.min_score, 3) + ")");
      before = point.min_score;
    }
    if (options.labels.empty())
      line("", "from scores alone, of the gates that were found at all: --labels measures");
    if (const std::string words = words_of(tuned.lens, config); !words.empty()) line("lens", words);
    line("chosen", "detector.min_score = " + files::text_of(tuned.chosen.min_score, 4));
    line("written", options.out + ", " + beside(options.out, kColors).filename().string() + ", " +
                        beside(options.out, kRocTable).filename().string() + ", " +
                        beside(options.out, kRocPlot).filename().string());
  } else {
    const std::string needed =
        options.labels.empty()
            ? ", it takes " + std::to_string(tuning::SelfTrainingParams{}.least_gates)
            : "";
    line("not fitted", "too few gates to learn from (" + std::to_string(tuned.gates) + needed +
                           "); the described colour is kept");
    line("", "more pictures of near gates, a --describe r,g,b read off a gate, or --labels");
    line("written", options.out);
  }
  if (options.labels.empty())
    line(tuned.learnt ? "next" : "see why",
         "gatefly detect " + options.images.front() + " --config " + options.out +
             (tuned.learnt ? " --annotate out/drawn" : " --debug out/why"));
  std::string left_out;
  const auto add = [&](int count, const char* what) {
    if (count > 0) left_out += (left_out.empty() ? "" : ", ") + std::to_string(count) + " " + what;
  };
  add(material.duplicates, "duplicate pictures"),
      add(material.without_label, "pictures without a label");
  add(material.labels_without_picture, "labels without their picture"),
      add(material.unusable, "unusable files");
  if (!left_out.empty()) line("left out", left_out);
}

config::Config config_of(const TuneOptions& options) {
  CommonOptions common = options.common;
  if (options.rotate_deg)
    common.settings.push_back("camera.stored_rotation_deg=" + std::to_string(*options.rotate_deg));
  config::Config config = load(common);
  if (options.describe.empty()) return config;
  try {
    const auto rgb = tuning::described_color(options.describe);
    config.gate.rgb = {rgb[0], rgb[1], rgb[2]};
    config.gate.fitted_color.reset();
    config.pilot = config::pilot_config(config);
  } catch (const std::invalid_argument& error) {
    throw std::runtime_error("--describe: " + std::string{error.what()});
  }
  return config;
}

/// gatefly tune: exit 0 fitted, 1 too few gates to fit, 2 unusable arguments or input (the rest is
/// done), 130 Ctrl-C.
int tune(const TuneOptions& options) {
  const config::Config config = config_of(options);
  check_outputs_of(options, config);
  catch_interrupt();
  Progress progress(options.common.quiet, 10'000.0);
  const Material material = gathered(options, config, progress);
  if (material.pictures.empty() && !interrupted())
    throw std::runtime_error("no picture could be used");

  const tuning::Judging judging{.detector = config.pilot.detector};
  Tuned tuned{.color = config.pilot.gate_color};
  if (!interrupted()) {
    if (progress.due(1e9)) progress.update(0.6, "fitting");
    tuned = options.labels.empty()
                ? tuning::tune_to_description(material.pictures, config.pilot.gate_color, judging,
                                              options.false_per_image)
                : tuning::tune_to_labels(material.pictures, config.pilot.gate_color, judging,
                                         options.false_per_image);
  }
  progress.clear();
  if (interrupted()) {
    complain("interrupted, nothing written");
    return kInterrupted;
  }
  write(options, config, material, tuned);
  if (options.json)
    std::cout << files::json_text(as_json(options, material, config, tuned));
  else
    print_screen(options, material, config, tuned);
  return material.unusable > 0 ? kUnusable : tuned.learnt ? kDone : kAnswerIsNo;
}

}  // namespace

void declare_tune(Command& command) {
  auto options = std::make_shared<TuneOptions>();
  command.footer(
      "Example:\n  gatefly tune --describe orange ../shared/data/tudelft_bebop_gates/cyberzoo "
      "--config cyberzoo --out mine.toml\n"
      "  gatefly tune --labels labels.csv pictures/ --config basement --out mine.toml\n"
      "  gatefly detect pictures/ --config basement --config mine.toml\n\n"
      "With --labels colours are fitted to the labelled gates; without, to what the described "
      "colour surely finds.\n"
      "A lens that no --config names is estimated from how the gates' bars bow: "
      "detector.lens_deg.\n"
      "detector.min_score is chosen on halves of the pictures, each searched with the other's "
      "colours. Beside FILE:\n"
      "FILE.colors.toml, FILE.roc.csv, FILE.roc.png. Exit code 0: fitted; 1: too few gates (the "
      "described colour is\n"
      "written); 2: something could not be used; 130: Ctrl-C.");
  command.option("IMAGES", options->images, "images and folders").required().path();
  command.option("--labels", options->labels, "labels.csv; pictures it does not name are left out")
      .path("FILE");
  command
      .option("--ignore", options->ignore,
              "quads that are neither gate nor background, as in score")
      .path("FILE");
  command
      .option("--describe", options->describe,
              "the gate's colour: orange, \"dark blue\", \"#rrggbb\", r,g,b [color.rgb]")
      .type_name("COLOR");
  command
      .option("--rotate", options->rotate_deg,
              "turn stored pictures counter-clockwise [as the camera of a --config, else EXIF, "
              "else upright]")
      .one_of({0, 90, 180, 270})
      .type_name("DEG");
  command
      .option("--false-per-image", options->false_per_image,
              "false positives a picture that are allowed")
      .between(0.0, 1.0)
      .show_default();
  command.option("--out", options->out, "the configuration to write").required().path("FILE");
  command
      .option("--data", options->data,
              "where a path is looked for that is not here [$GATEFLY_DATA]")
      .path("DIR");
  command.flag("--json", options->json, "print JSON");
  add_force(command, options->common);
  add_common(command, options->common);
  command.runs([options] { return tune(*options); });
}

}  // namespace gatefly::cli
