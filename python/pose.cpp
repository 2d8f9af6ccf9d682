// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>

#include <pybind11/stl.h>

#include "gatefly/files/text.hpp"
#include "gatefly/geometry/attitude.hpp"
#include "gatefly/pose/gate_fix.hpp"

#include "arguments.hpp"
#include "arrays.hpp"
#include "bindings.hpp"

namespace gatefly::python {
namespace {

using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// `rows` x `columns` finite numbers of anything numpy makes an array of; columns 0: one dimension.
Numbers numbers(const py::object& value, const char* what, py::ssize_t rows, py::ssize_t columns) {
  const py::object array = py::module_::import("numpy").attr("asarray")(value);
  const std::string kind = py::str(array.attr("dtype").attr("kind"));
  if (kind != "f" && kind != "i" && kind != "u")
    throw py::type_error(std::string{what} + " must be numbers");
  const Numbers result = Numbers::ensure(array);
  if (!result) throw py::error_already_set();
  const bool fits =
      columns == 0 ? result.ndim() == 1 && result.shape(0) == rows
                   : result.ndim() == 2 && result.shape(0) == rows && result.shape(1) == columns;
  if (!fits)
    throw std::runtime_error(
        std::string{what} + " has shape " + std::string(py::str(array.attr("shape"))) +
        ", must be (" + std::to_string(rows) +
        (columns == 0 ? std::string{",)"} : ", " + std::to_string(columns) + ")"));
  for (py::ssize_t i = 0; i < result.size(); ++i)
    if (!std::isfinite(result.data()[i]))
      throw std::runtime_error(std::string{what} + " must be finite");
  return result;
}

Quad quad_of(const py::object& corners) {
  const Numbers values = numbers(corners, "corners_px", 4, 2);
  Quad quad;
  for (std::size_t i = 0; i < 4; ++i)
    quad[i] = Eigen::Vector2d{values.data()[2 * i], values.data()[2 * i + 1]};
  return quad;
}

template <int kSize>
Eigen::Matrix<double, kSize, 1> vector_of(const py::object& value, const char* what) {
  return Eigen::Matrix<double, kSize, 1>{numbers(value, what, kSize, 0).data()};
}

/// gatefly.Camera: the lens, how it is mounted, and what a fix needs to know.
class Camera {
 public:
  Camera(const py::object& config, const py::object& settings)
      : config_{tasks::load(config_arguments(config, settings))} {
    warn(config_.notes);
  }

  using Method = std::optional<Fix> (*)(const Quad&, const RotationGB&, double, const CameraRig&,
                                        const PoseParams&);
  template <Method kMethod>
  [[nodiscard]] std::optional<Fix> fix(const py::object& corners_px, double roll, double pitch,
                                       double yaw, std::optional<double> side) const {
    const Quad quad = quad_of(corners_px);
    for (const double angle : {roll, pitch, yaw})
      if (!std::isfinite(angle)) throw std::runtime_error("roll, pitch and yaw must be finite");
    const double length = side.value_or(config_.gate.side);
    if (!(length > 0.0 && std::isfinite(length)))
      throw std::runtime_error("side = " + files::text_of(length) + ", must be > 0");
    const RotationGB R_GB{rotation_EB(Attitude{roll, pitch, yaw}).matrix};
    return kMethod(quad, R_GB, length, rig(), config_.pilot.pose);
  }

  [[nodiscard]] const CameraRig& rig() const { return config_.pilot.camera; }
  [[nodiscard]] const config::Config& config() const { return config_; }

 private:
  config::Config config_;
};

py::object optional_array(const auto& value) {
  return value ? py::object{array_of(*value)} : py::none();
}

void bind_fix(py::module_& m) {
  py::class_<Fix>(m, "Fix", "Where the drone is relative to one gate, from one picture.")
      .def_property_readonly(
          "p_GB", [](const Fix& fix) { return array_of(fix.p_GB); },
          "The body in the gate's frame [m]: x through the gate (negative before it), y right, z "
          "down.")
      .def_property_readonly(
          "covariance", [](const Fix& fix) { return array_of(fix.covariance); },
          "Of p_GB (3, 3) [m^2].")
      .def_readonly(
          "yaw_error", &Fix::yaw_error,
          "What has to be added to the yaw that was given [rad]; None where the corners do "
          "not say.")
      .def_readonly("yaw_variance", &Fix::yaw_variance, "Of yaw_error [rad^2].")
      .def("__repr__", [](const Fix& fix) {
        return "<gatefly.Fix p_GB (" + files::fixed(fix.p_GB.x(), 3) + ", " +
               files::fixed(fix.p_GB.y(), 3) + ", " + files::fixed(fix.p_GB.z(), 3) + ") m>";
      });
}

}  // namespace

void bind_pose(py::module_& m) {
  bind_fix(m);
  py::class_<Camera>(
      m, "Camera",
      "A camera and how it sits on the drone, as a configuration's [camera] says; the "
      "Bebop's by default.")
      .def(py::init<const py::object&, const py::object&>(), py::arg("config") = py::none(),
           py::arg("settings") = py::none())
      .def_property_readonly(
          "width", [](const Camera& c) { return c.config().camera.width; },
          "Of the upright picture [px].")
      .def_property_readonly(
          "height", [](const Camera& c) { return c.config().camera.height; },
          "Of the upright picture [px].")
      .def_property_readonly(
          "R_BC", [](const Camera& c) { return array_of(c.rig().R_BC.matrix); },
          "Orientation (3, 3): v_B = R_BC @ v_C.")
      .def_property_readonly(
          "p_BC", [](const Camera& c) { return array_of(c.rig().p_BC); },
          "Focal point in the body frame [m].")
      .def(
          "project",
          [](const Camera& c, const py::object& p_C) {
            return optional_array(c.rig().lens.project(vector_of<3>(p_C, "p_C")));
          },
          "The pixel (u, v) of a point in the camera frame (right, down, forward) [m]; None where "
          "the lens shows\nnothing.",
          py::arg("p_C"))
      .def(
          "bearing",
          [](const Camera& c, const py::object& px) {
            return optional_array(c.rig().lens.bearing(vector_of<2>(px, "px")));
          },
          "The unit vector in the camera frame to a pixel (u, v); None where the lens shows "
          "nothing.",
          py::arg("px"))
      .def(
          "fix_from_corners", &Camera::fix<fix_from_corners>,
          "Where the body is, from a gate's four outer corners and the attitude [rad]: the point "
          "nearest to the\nfour rays (the paper's way, Eq. 5-9). yaw is relative to the gate. "
          "side: "
          "outer side of the gate [m],\nas the configuration by default. None when the rays do not "
          "meet in a point before the gate.",
          py::arg("corners_px"), py::arg("roll"), py::arg("pitch"), py::arg("yaw"),
          py::arg("side") = py::none())
      .def("map_fix_from_corners", &Camera::fix<map_fix_from_corners>,
           "The same by the most probable pose, as the pilot flies: corners that no gate in this "
           "attitude could show\nare None.",
           py::arg("corners_px"), py::arg("roll"), py::arg("pitch"), py::arg("yaw"),
           py::arg("side") = py::none());
}

}  // namespace gatefly::python
