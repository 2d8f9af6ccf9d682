// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "gatefly/detection/gate_detector.hpp"
#include "gatefly/files/detections_file.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/tasks/gates_in_picture.hpp"

#include "arguments.hpp"
#include "arrays.hpp"
#include "bindings.hpp"
#include "json.hpp"
#include "picture.hpp"

namespace gatefly::python {
namespace {

/// gatefly.Detector: what `gatefly detect` is, between two pictures.
class Detector {
 public:
  Detector(const py::object& config, const py::object& settings, bool all)
      : config_{tasks::load(config_arguments(config, settings))},
        detector_{config_.pilot.detector, config_.pilot.detector_mode},
        all_{all} {
    warn(config_.notes);
  }

  [[nodiscard]] py::list detect(const py::object& image) {
    const Picture picture = picture_of(image);
    std::vector<GateDetection> gates;
    {
      const py::gil_scoped_release others_may_run;
      const std::lock_guard one_at_a_time{mutex_};
      gates = tasks::gates_in_picture(picture.view(), detector_, config_.pilot, all_);
    }
    py::list list(gates.size());
    for (std::size_t i = 0; i < gates.size(); ++i) list[i] = py::cast(gates[i]);
    return list;
  }

  [[nodiscard]] const config::Config& config() const { return config_; }
  [[nodiscard]] bool all() const { return all_; }

 private:
  config::Config config_;
  GateDetector detector_;
  bool all_;
  std::mutex mutex_;
};

std::string method_of(const GateDetection& gate) { return files::row_of("", 0, gate).method; }

std::string text_of(const GateDetection& gate) {
  std::string text =
      "<gatefly.Gate " + method_of(gate) + ", fitness " + files::fixed(gate.fitness, 2);
  for (const Eigen::Vector2d& corner : gate.corners_px)
    text += ", (" + files::fixed(corner.x(), 1) + ", " + files::fixed(corner.y(), 1) + ")";
  return text + ">";
}

}  // namespace

void bind_detector(py::module_& m) {
  py::class_<GateDetection>(m, "Gate", "A gate found in a picture, or a part of one.")
      .def_property_readonly(
          "corners_px", [](const GateDetection& gate) { return array_of(gate.corners_px); },
          "Outer corners (4, 2): u right, v down, clockwise from top-left, upright picture, pixel "
          "centres at\nintegers. Of method 'bars' a corner of fitness 0 is not in view: there its "
          "bar leaves the picture.")
      .def_readonly("fitness", &GateDetection::fitness,
                    "0..1: part of such frames that were gates.")
      .def_property_readonly(
          "corner_fitness",
          [](const GateDetection& gate) {
            return py::array_t<double>(4, gate.corner_fitness.data());
          },
          "0..1 of each corner; 0: not in the picture.")
      .def_property_readonly("method", method_of,
                             "Who found it: 'snake', 'frames', or 'bars' for one that the border "
                             "cuts.")
      .def("__repr__", text_of);

  py::class_<Detector>(
      m, "Detector",
      "Finds gates; to be made once and used for many pictures.\n\n"
      "config: a file, a name in configs/ or a list of them; settings: {'section.key': value}, as "
      "--config and\n--set of the program. all: every gate instead of the best.")
      .def(py::init<const py::object&, const py::object&, bool>(), py::arg("config") = py::none(),
           py::arg("settings") = py::none(), py::arg("all") = false)
      .def("detect", &Detector::detect,
           "The gates in a picture, best first: those that `gatefly detect` lists. image: an "
           "upright "
           "RGB array\n(height, width, 3) of uint8, copied only where it is not contiguous, or an "
           "Image.",
           py::arg("image"))
      .def("__call__", &Detector::detect, "detect().", py::arg("image"))
      .def(
          "read_image",
          [](const Detector& detector, const py::object& path) {
            return read_picture(path, detector.config());
          },
          "read_image() with this detector's configuration.", py::arg("path"))
      .def_property_readonly("all", &Detector::all, "Whether every gate is listed.")
      .def_property_readonly(
          "config", [](const Detector& d) { return python_of(config::as_json(d.config())); },
          "Effective configuration: {section: {key: value}}, a copy.");

  m.def(
      "detect",
      [](const py::object& image, const py::object& config, const py::object& settings, bool all) {
        return std::make_unique<Detector>(config, settings, all)->detect(image);
      },
      "The gates in one picture; for many make a Detector, which reads its configuration once.",
      py::arg("image"), py::arg("config") = py::none(), py::arg("settings") = py::none(),
      py::arg("all") = false);
}

}  // namespace gatefly::python
