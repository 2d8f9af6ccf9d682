// SPDX-License-Identifier: Apache-2.0
#include "gatefly/tasks/calibration/camera_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include <yaml-cpp/yaml.h>

#include "gatefly/config/check_config.hpp"
#include "gatefly/config/config.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/tasks/calibration/lens_model.hpp"

namespace gatefly::calibration {
namespace {

using Numbers = std::vector<double>;

/// One YAML map, with what errors have to name.
class Map {
 public:
  Map(YAML::Node node, std::string where) : node_{std::move(node)}, where_{std::move(where)} {}

  [[nodiscard]] bool has(const std::string& key) const { return node_[key].IsDefined(); }
  [[noreturn]] void fail(const std::string& key, const std::string& what) const {
    throw std::runtime_error(where_ + key + what);
  }
  [[nodiscard]] std::string text(const std::string& key) const {
    const YAML::Node value = node_[key];
    if (!value.IsDefined() || !value.IsScalar()) fail(key, " is missing: must be a word");
    return value.as<std::string>();
  }
  /// A list, or a matrix's `data`; must have `count` numbers, or any number of them.
  [[nodiscard]] Numbers numbers(const std::string& key, std::size_t count = 0) const {
    const YAML::Node value = node_[key];
    const YAML::Node list = value.IsDefined() && value.IsMap() ? value["data"] : value;
    const std::string need =
        ": must be a list of " + (count > 0 ? std::to_string(count) + " " : "") + "numbers";
    if (!list.IsDefined() || !list.IsSequence()) fail(key, need);
    Numbers numbers;
    for (const YAML::Node& each : list) {
      double number = 0.0;
      if (!each.IsScalar() || !YAML::convert<double>::decode(each, number) ||
          !std::isfinite(number))
        fail(key, need);
      numbers.push_back(number);
    }
    if (count > 0 && numbers.size() != count) fail(key, need);
    return numbers;
  }
  [[nodiscard]] int integer(const std::string& key) const {
    int number = 0;
    const YAML::Node value = node_[key];
    if (!value.IsDefined() || !value.IsScalar() || !YAML::convert<int>::decode(value, number) ||
        number < 1)
      fail(key, ": must be a whole number above 0");
    return number;
  }
  [[nodiscard]] Map map(const std::string& key) const { return {node_[key], where_ + key + "."}; }

 private:
  YAML::Node node_;
  std::string where_;
};

bool all_zero(const Numbers& numbers) {
  return std::all_of(numbers.begin(), numbers.end(), [](double each) { return each == 0.0; });
}

/// @param intrinsics  fx, fy, cx, cy.
AnyCamera lens_from(const Map& map, const Numbers& intrinsics, const std::string& model, Numbers d,
                    const std::string& d_key) {
  const Eigen::Vector2d focal_px{intrinsics[0], intrinsics[1]},
      center_px{intrinsics[2], intrinsics[3]};
  if (!(focal_px.minCoeff() > 0.0))
    map.fail("", "focal length = " + files::text_of(focal_px.minCoeff()) + ": must be above 0");
  const auto need = [&](std::size_t low, std::size_t high, const std::string& what) {
    if (d.size() < low || d.size() > high)
      map.fail(d_key, " has " + std::to_string(d.size()) + " numbers, " + model + " has " + what);
  };
  if (model == "none") {
    if (!all_zero(d)) map.fail(d_key, ": must be empty or zeros with \"none\"");
    return {Pinhole{focal_px, center_px}};
  }
  if (model == "radtan" || model == "plumb_bob") {
    if (model == "radtan")
      need(4, 4, "k1, k2, p1, p2");
    else
      need(4, 5, "k1, k2, p1, p2, k3");
    if (all_zero(d)) return {Pinhole{focal_px, center_px}};
    d.resize(5, 0.0);
    return {BrownConrady{focal_px, center_px, {d[0], d[1], d[2], d[3], d[4]}}};
  }
  if (model == "equidistant") {
    need(4, 4, "k1, k2, k3, k4");
    return {KannalaBrandt{focal_px, center_px, RadialPolynomial{{d[0], d[1], d[2], d[3]}}}};
  }
  map.fail("distortion_model",
           " = " + files::one_line(model) +
               ": gatefly has no such lens; radtan, plumb_bob (Brown-Conrady) "
               "and equidistant (Kannala-Brandt) can be read: calibrate anew with one of them");
}

CameraFile from_kalibr(const Map& map) {
  if (const std::string model = map.text("camera_model"); model != "pinhole")
    map.fail("camera_model", " = " + files::one_line(model) +
                                 ": must be pinhole (with radtan, equidistant or none)");
  const Numbers size = map.numbers("resolution", 2);
  constexpr double kLargest = 1e6;
  for (const double side : size)
    if (!(side >= 1.0 && side <= kLargest && side == std::floor(side)))
      map.fail("resolution", " has " + files::text_of(side) + ": must be whole numbers above 0");
  CameraFile camera;
  camera.size_px = {static_cast<int>(size[0]), static_cast<int>(size[1])};
  const Numbers distortion =
      map.has("distortion_coeffs") ? map.numbers("distortion_coeffs") : Numbers{};
  camera.lens = lens_from(map, map.numbers("intrinsics", 4), map.text("distortion_model"),
                          distortion, "distortion_coeffs");
  return camera;
}

/// The first of these keys that is there: files, ROS 1's messages and ROS 2's spell them
/// differently.
std::string first_of(const Map& map, const std::array<const char*, 3>& keys) {
  for (const char* key : keys)
    if (map.has(key)) return key;
  return keys[0];
}

CameraFile from_ros(const Map& map) {
  CameraFile camera;
  camera.size_px = {map.integer(first_of(map, {"image_width", "width", "width"})),
                    map.integer(first_of(map, {"image_height", "height", "height"}))};
  const std::string k_key = first_of(map, {"camera_matrix", "K", "k"}),
                    d_key = first_of(map, {"distortion_coefficients", "D", "d"});
  const Numbers k = map.numbers(k_key, 9);
  if (k[1] != 0.0 || k[3] != 0.0 || k[6] != 0.0 || k[7] != 0.0 || k[8] != 1.0)
    map.fail(k_key, ": must be [fx, 0, cx, 0, fy, cy, 0, 0, 1]; gatefly has no skewed pixels");
  camera.lens = lens_from(map, {k[0], k[4], k[2], k[5]}, map.text("distortion_model"),
                          map.numbers(d_key), d_key);
  return camera;
}

CameraFile from_toml(const std::filesystem::path& path) {
  const config::Config config = config::load_config(std::vector<std::filesystem::path>{path});
  for (const char* key : {"camera.model", "camera.size_px", "camera.focal_px", "camera.center_px"})
    if (!config.set_by.contains(key))
      throw std::runtime_error(path.string() + ": " + key + " is missing");
  CameraFile camera{config.pilot.camera.lens,
                    {config.camera.width, config.camera.height},
                    config.camera.stored_rotation_deg,
                    {}};
  if (!config.set_by.contains("camera.stored_rotation_deg")) camera.stored_rotation_deg = 0;
  if (config.set_by.contains("camera.tilt_deg")) camera.tilt_down = config.camera.tilt_down;
  return camera;
}

/// The camera of a camchain, by name.
std::string chosen_camera(const YAML::Node& file, const std::string& path,
                          const std::string& camera) {
  std::vector<std::string> names;
  for (const auto& each : file)
    if (each.second.IsMap() && each.second["intrinsics"].IsDefined())
      names.push_back(each.first.as<std::string>());
  if (camera.empty() && names.size() == 1) return names[0];
  if (std::find(names.begin(), names.end(), camera) != names.end()) return camera;
  throw std::runtime_error(path + ": " +
                           (camera.empty() ? "holds several cameras"
                                           : "has no camera '" + files::one_line(camera) + "'") +
                           ": --camera must be one of " + files::joined(names));
}

CameraFile from_yaml(const std::filesystem::path& path, const std::string& camera) {
  constexpr std::uintmax_t kMostBytes = std::uintmax_t{1} << 20;
  const YAML::Node file = YAML::Load(files::read_file(path, kMostBytes));
  const std::string where = path.string() + ": ";
  if (!file.IsMap())
    throw std::runtime_error(where + "is neither a Kalibr camchain nor a ROS camera_info");
  const Map map(file, where);
  if (map.has("camera_matrix") || map.has("K") || map.has("k")) return from_ros(map);
  for (const auto& each : file)
    if (each.second.IsMap() && each.second["intrinsics"].IsDefined())
      return from_kalibr(map.map(chosen_camera(file, path.string(), camera)));
  throw std::runtime_error(
      where +
      "is neither a Kalibr camchain (cam0: intrinsics) nor a ROS camera_info (camera_matrix)");
}

std::string list(const Numbers& numbers) {
  std::vector<std::string> words;
  for (const double number : numbers) {
    std::string word = files::text_of(number);
    if (word.find_first_of(".en") == std::string::npos) word += ".0";
    words.push_back(std::move(word));
  }
  return "[" + files::joined(words) + "]";
}

struct Parts {
  LensModel model;
  Numbers focal_px, center_px, distortion;
};

Parts parts_of(const AnyCamera& lens) {
  const LensParameters all = parameters_of(lens);
  const auto& p = all.parameters;
  return {all.model, {p[0], p[1]}, {p[2], p[3]}, {p.data() + 4, p.data() + p.size()}};
}

[[noreturn]] void no_place(const std::string& what, const std::string& format,
                           const std::string& instead) {
  throw std::runtime_error(what + " has no place in a file of " + format + ": take " + instead);
}

std::string kalibr_text(const CameraFile& camera) {
  Parts parts = parts_of(camera.lens);
  std::string model = "none";
  if (parts.model == LensModel::kDhane)
    no_place("Dhane's lens", "Kalibr", "--model kannala-brandt");
  if (parts.model == LensModel::kKannalaBrandt) model = "equidistant";
  if (parts.model == LensModel::kBrownConrady) {
    if (parts.distortion[4] != 0.0)
      no_place("Brown-Conrady with k3 = " + files::text_of(parts.distortion[4], 4),
               "Kalibr (radtan: k1, k2, p1, p2)", "--zero k3, --model kannala-brandt, or --to ros");
    model = "radtan";
    parts.distortion.pop_back();
  }
  Numbers intrinsics = parts.focal_px;
  intrinsics.insert(intrinsics.end(), parts.center_px.begin(), parts.center_px.end());
  return "cam0:\n  camera_model: pinhole\n  intrinsics: " + list(intrinsics) +
         "\n  distortion_model: " + model + "\n  distortion_coeffs: " + list(parts.distortion) +
         "\n  resolution: [" + std::to_string(camera.size_px.x()) + ", " +
         std::to_string(camera.size_px.y()) + "]\n";
}

std::string matrix(const std::string& name, std::size_t rows, std::size_t columns,
                   const Numbers& data) {
  return name + ":\n  rows: " + std::to_string(rows) + "\n  cols: " + std::to_string(columns) +
         "\n  data: " + list(data) + "\n";
}

std::string ros_text(const CameraFile& camera) {
  Parts parts = parts_of(camera.lens);
  std::string model = "plumb_bob";
  if (parts.model == LensModel::kDhane) no_place("Dhane's lens", "ROS", "--model kannala-brandt");
  if (parts.model == LensModel::kKannalaBrandt) model = "equidistant";
  if (parts.model == LensModel::kPinhole) parts.distortion.assign(5, 0.0);
  const double fx = parts.focal_px[0], fy = parts.focal_px[1], cx = parts.center_px[0],
               cy = parts.center_px[1];
  return "image_width: " + std::to_string(camera.size_px.x()) +
         "\nimage_height: " + std::to_string(camera.size_px.y()) + "\ncamera_name: gatefly\n" +
         matrix("camera_matrix", 3, 3, {fx, 0, cx, 0, fy, cy, 0, 0, 1}) +
         "distortion_model: " + model + "\n" +
         matrix("distortion_coefficients", 1, parts.distortion.size(), parts.distortion) +
         matrix("rectification_matrix", 3, 3, {1, 0, 0, 0, 1, 0, 0, 0, 1}) +
         matrix("projection_matrix", 3, 4, {fx, 0, cx, 0, 0, fy, cy, 0, 0, 0, 1, 0});
}

std::string toml_text(const CameraFile& camera) {
  const Parts parts = parts_of(camera.lens);
  std::string distortion;
  for (const std::string& name : parameter_names(parts.model))
    if (name.starts_with('k') || name.starts_with('p'))
      distortion += (distortion.empty() ? "  # " : ", ") + name;
  std::string text = "[camera]\nmodel = \"" + name_of(parts.model) + "\"\nsize_px = [" +
                     std::to_string(camera.size_px.x()) + ", " +
                     std::to_string(camera.size_px.y()) + "]\nfocal_px = " + list(parts.focal_px) +
                     "\ncenter_px = " + list(parts.center_px) +
                     "\ndistortion = " + list(parts.distortion) + distortion +
                     "\nstored_rotation_deg = " + std::to_string(camera.stored_rotation_deg) + "\n";
  if (camera.tilt_down)
    text += "tilt_deg = " + files::text_of(*camera.tilt_down / kDegree, 6) + "\n";
  return text;
}

}  // namespace

CameraFormat camera_format(const std::string& name) {
  return name == "kalibr" ? CameraFormat::kKalibr
         : name == "ros"  ? CameraFormat::kRos
                          : CameraFormat::kToml;
}

CameraFile read_camera(const std::filesystem::path& path, const std::string& camera) {
  if (path.extension() == ".toml") return from_toml(path);
  try {
    return from_yaml(path, camera);
  } catch (const YAML::Exception& error) {
    throw std::runtime_error(path.string() + ":" + std::to_string(error.mark.line + 1) +
                             ": is no YAML: " + files::one_line(error.msg));
  }
}

void expect_usable(const CameraFile& camera, const std::string& where) {
  try {
    config::check_config(toml_text(camera), "");
  } catch (const std::runtime_error& error) {
    const std::string what = error.what();
    throw std::runtime_error(where +
                             ": such a camera cannot be used: " + what.substr(what.find(": ") + 2));
  }
}

std::string camera_text(const CameraFile& camera, CameraFormat format,
                        const std::vector<std::string>& comments) {
  std::string text;
  for (const std::string& comment : comments)  // which may name a file, whose name may be anything
    text += "# " + files::one_line(comment, 400) + "\n";
  switch (format) {
    case CameraFormat::kKalibr:
      return text + kalibr_text(camera);
    case CameraFormat::kRos:
      return text + ros_text(camera);
    case CameraFormat::kToml:
      break;
  }
  return text + toml_text(camera);
}

AnyCamera short_lens(const LensFit& fit) {
  Eigen::VectorXd parameters = fit.parameters;
  constexpr int kDigits = 8;
  for (double& each : parameters) each = std::stod(files::text_of(each, kDigits));
  return lens_of(fit.model, parameters);
}

}  // namespace gatefly::calibration
