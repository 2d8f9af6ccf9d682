// SPDX-License-Identifier: Apache-2.0
#include "gatefly/simulated_race/results/mcap_schemas.hpp"

#include <initializer_list>
#include <string>
#include <utility>

namespace gatefly::simulated_race::schema {
namespace {

/// All of its properties are required.
Json object(const std::string& title,
            std::initializer_list<std::pair<const char*, Json>> properties) {
  Json json{{"type", "object"}};
  if (!title.empty()) json["title"] = title;
  json["properties"] = Json::object();
  json["required"] = Json::array();
  for (const auto& [name, property] : properties) {
    json["properties"][name] = property;
    json["required"].push_back(name);
  }
  return json;
}

Json array_of(const Json& items) { return {{"type", "array"}, {"items", items}}; }
Json number() { return {{"type", "number"}}; }
Json integer() { return {{"type", "integer"}}; }
Json text() { return {{"type", "string"}}; }
Json yes_or_no() { return {{"type", "boolean"}}; }

Json described(Json json, const std::string& description) {
  json["description"] = description;
  return json;
}

Json moment(const std::string& title) {
  const Json nanoseconds{{"type", "integer"}, {"minimum", 0}, {"maximum", 999'999'999}};
  return object(title, {{"sec", integer()}, {"nsec", nanoseconds}});
}
Json time() { return moment("time"); }

Json vector3() {
  return object("foxglove.Vector3", {{"x", number()}, {"y", number()}, {"z", number()}});
}
Json quaternion() {
  return object("foxglove.Quaternion",
                {{"x", number()}, {"y", number()}, {"z", number()}, {"w", number()}});
}
Json pose() {
  return object("foxglove.Pose", {{"position", vector3()}, {"orientation", quaternion()}});
}
Json point2() { return object("foxglove.Point2", {{"x", number()}, {"y", number()}}); }
Json color() {
  return object("foxglove.Color",
                {{"r", number()}, {"g", number()}, {"b", number()}, {"a", number()}});
}
/// Schema of fields that we never send.
Json always_empty() { return array_of(Json{{"type", "object"}}); }

/// x, y, z or roll, pitch, yaw as an object, so that a plot can name one of them.
Json named(std::initializer_list<const char*> names, const std::string& description) {
  Json json{{"type", "object"}, {"properties", Json::object()}, {"required", Json::array()}};
  for (const char* name : names) {
    json["properties"][name] = number();
    json["required"].push_back(name);
  }
  return described(std::move(json), description);
}
Json xyz(const std::string& description) { return named({"x", "y", "z"}, description); }
Json attitude() {
  return named({"roll", "pitch", "yaw"}, "Of the body in north, east, down [rad]");
}

Json or_null(Json json) {
  for (auto& property : json["properties"]) property["type"] = {"number", "null"};
  return json;
}

}  // namespace

Json frame_transforms() {
  const Json transform = object("foxglove.FrameTransform", {{"timestamp", time()},
                                                            {"parent_frame_id", text()},
                                                            {"child_frame_id", text()},
                                                            {"translation", vector3()},
                                                            {"rotation", quaternion()}});
  return object("foxglove.FrameTransforms", {{"transforms", array_of(transform)}});
}

Json pose_in_frame() {
  return object("foxglove.PoseInFrame",
                {{"timestamp", time()}, {"frame_id", text()}, {"pose", pose()}});
}

Json compressed_image() {
  const Json data{{"type", "string"}, {"contentEncoding", "base64"}};
  return object("foxglove.CompressedImage",
                {{"timestamp", time()}, {"frame_id", text()}, {"data", data}, {"format", text()}});
}

Json image_annotations() {
  const Json points = object("foxglove.PointsAnnotation", {{"timestamp", time()},
                                                           {"type", integer()},
                                                           {"points", array_of(point2())},
                                                           {"outline_color", color()},
                                                           {"outline_colors", array_of(color())},
                                                           {"fill_color", color()},
                                                           {"thickness", number()}});
  return object(
      "foxglove.ImageAnnotations",
      {{"circles", always_empty()}, {"points", array_of(points)}, {"texts", always_empty()}});
}

Json scene_update() {
  const Json cube =
      object("foxglove.CubePrimitive", {{"pose", pose()}, {"size", vector3()}, {"color", color()}});
  const Json cylinder = object("foxglove.CylinderPrimitive", {{"pose", pose()},
                                                              {"size", vector3()},
                                                              {"bottom_scale", number()},
                                                              {"top_scale", number()},
                                                              {"color", color()}});
  const Json line = object("foxglove.LinePrimitive", {{"type", integer()},
                                                      {"pose", pose()},
                                                      {"thickness", number()},
                                                      {"scale_invariant", yes_or_no()},
                                                      {"points", array_of(vector3())},
                                                      {"color", color()},
                                                      {"colors", array_of(color())},
                                                      {"indices", array_of(integer())}});
  const Json label = object("foxglove.TextPrimitive", {{"pose", pose()},
                                                       {"billboard", yes_or_no()},
                                                       {"font_size", number()},
                                                       {"scale_invariant", yes_or_no()},
                                                       {"color", color()},
                                                       {"text", text()}});
  const Json entity = object("foxglove.SceneEntity", {{"timestamp", time()},
                                                      {"frame_id", text()},
                                                      {"id", text()},
                                                      {"lifetime", moment("duration")},
                                                      {"frame_locked", yes_or_no()},
                                                      {"metadata", always_empty()},
                                                      {"arrows", always_empty()},
                                                      {"cubes", array_of(cube)},
                                                      {"spheres", always_empty()},
                                                      {"cylinders", array_of(cylinder)},
                                                      {"lines", array_of(line)},
                                                      {"triangles", always_empty()},
                                                      {"texts", array_of(label)},
                                                      {"models", always_empty()}});
  return object("foxglove.SceneUpdate",
                {{"deletions", always_empty()}, {"entities", array_of(entity)}});
}

Json truth() {
  return object("gatefly.Truth", {{"position_m", xyz("North, east, down [m]")},
                                  {"velocity_mps", xyz("North, east, down [m/s]")},
                                  {"attitude_rad", attitude()}});
}

Json estimate() {
  return object(
      "gatefly.Estimate",
      {{"position_m", xyz("North, east, down [m]")},
       {"velocity_mps", xyz("North, east, down [m/s]")},
       {"attitude_rad", attitude()},
       {"accel_bias_mps2", xyz("Front, right, down [m/s²]")},
       {"gyro_bias_radps", xyz("Front, right, down [rad/s]")},
       {"sigma_m", xyz("One standard deviation of the position, along the target gate's axes: "
                       "through it, right, down [m]")},
       {"target_gate", described(integer(), "From 0")},
       {"gates_passed", described(integer(), "As the pilot believes")}});
}

Json imu() {
  return object(
      "gatefly.Imu",
      {{"gyro_radps", or_null(xyz("Front, right, down [rad/s], every eighth sample, not averaged, "
                                  "rounded to 1e-4; null: a lost one"))},
       {"accel_mps2", or_null(xyz("Specific force: front, right, down [m/s²]"))}});
}

Json detections() {
  const Json corners =
      described(array_of(array_of(number())),
                "Outer corners from top-left, clockwise: u, v [px], upright, pixel "
                "centres at integers");
  const Json gate =
      object("", {{"corners_px", corners}, {"fitness", number()}, {"method", text()}});
  return object("gatefly.Detections",
                {{"exposed_s", described(number(), "When the picture's exposure began [s]")},
                 {"gates", described(array_of(gate), "The fittest first")},
                 {"used", described(integer(), "Index of the one that gave a fix; -1: none")},
                 {"source", described(text(), "What corrected the filter: none, corners, bars")},
                 {"nis", described(number(), "Normalised innovation squared of that fix")}});
}

Json control() {
  return object(
      "gatefly.Control",
      {{"phase", text()},
       {"target_gate", described(integer(), "From 0")},
       {"attitude_rad", attitude()},
       {"thrust_mps2", described(number(), "Specific thrust, positive lifts [m/s²]")},
       {"motors_radps", named({"lf", "rf", "rb", "lb"}, "Commanded rotor speeds [rad/s]")}});
}

}  // namespace gatefly::simulated_race::schema
