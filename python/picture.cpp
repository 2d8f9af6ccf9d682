// SPDX-License-Identifier: Apache-2.0
#include "picture.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include <pybind11/numpy.h>

#include "gatefly/files/image_file.hpp"
#include "gatefly/tasks/upright.hpp"

#include "arguments.hpp"
#include "bindings.hpp"

namespace gatefly::python {
namespace {

using Bytes = py::array_t<std::uint8_t, py::array::c_style>;

constexpr py::ssize_t kLargestSide = 16384;  // [px], as of files

std::string text_of(py::handle value) { return py::str(value); }

void check_rotation(int rotation) {
  if (rotation != 0 && rotation != 90 && rotation != 180 && rotation != 270)
    throw std::runtime_error("rotation = " + std::to_string(rotation) +
                             ", must be 0, 90, 180 or 270");
}

void check_size(py::ssize_t width, py::ssize_t height) {
  if (width < 1 || height < 1 || width > kLargestSide || height > kLargestSide)
    throw std::runtime_error("a picture of " + std::to_string(width) + " x " +
                             std::to_string(height) + " pixels: each side must be in 1..16384");
}

/// numpy's array of what says that it can be one: a picture of PIL, a tensor.
py::array array_in(const py::object& image) {
  if (py::isinstance<py::array>(image)) return image;
  if (!py::hasattr(image, "__array__"))
    throw py::type_error(
        "a picture is a gatefly.Image or a numpy array (height, width, 3) of uint8, not " +
        text_of(py::type::handle_of(image).attr("__name__")) +
        (py::isinstance<py::str>(image) || py::hasattr(image, "__fspath__")
             ? "; gatefly.read_image reads a file"
             : ""));
  return py::module_::import("numpy").attr("asarray")(image);
}

/// `array`, (height, width, 3) of uint8, where it lies line by line without gaps; else copied so: several times as fast as
/// numpy does it.
Bytes contiguous(const py::array& array) {
  if ((array.flags() & py::array::c_style) != 0) return array;
  const py::ssize_t height = array.shape(0), width = array.shape(1);
  const py::ssize_t down = array.strides(0), along = array.strides(1), deep = array.strides(2);
  Bytes copy({height, width, py::ssize_t{3}});
  std::uint8_t* to = copy.mutable_data();
  for (py::ssize_t v = 0; v < height; ++v) {
    const auto* from = static_cast<const std::uint8_t*>(array.data()) + v * down;
    for (py::ssize_t u = 0; u < width; ++u, from += along, to += 3)
      to[0] = from[0], to[1] = from[deep], to[2] = from[2 * deep];
  }
  return copy;
}

/// Image from an array (height, width, 3) of uint8.
Picture picture_in(const py::object& image, PixelFormat format, int rotation) {
  check_rotation(rotation);
  py::array array = array_in(image);
  const std::string shape = text_of(array.attr("shape"));
  if (array.dtype().kind() != 'u' || array.itemsize() != 1)
    throw py::type_error("a picture of " + text_of(array.dtype()) + ", must be uint8 (0..255)");
  if (array.ndim() == 2)
    throw std::runtime_error(
        "a picture of shape " + shape +
        " has no colour, by which gates are found: must be (height, width, 3)");
  if (array.ndim() != 3 || array.shape(2) != 3)
    throw std::runtime_error("a picture of shape " + shape + ", must be (height, width, 3)");
  check_size(array.shape(1), array.shape(0));
  const Bytes bytes = contiguous(array);
  return {.owner = bytes,
          .bytes = bytes.data(),
          .format = format,
          .stored_width = static_cast<int>(array.shape(1)),
          .stored_height = static_cast<int>(array.shape(0)),
          .rotation_deg = rotation};
}

Picture from_uyvy(const py::object& data, int width, int height, int rotation) {
  check_rotation(rotation);
  check_size(width, height);
  if (width % 2 != 0)
    throw std::runtime_error("width = " + std::to_string(width) +
                             ", must be even: UYVY stores pairs of pixels");
  if (!PyObject_CheckBuffer(data.ptr()))
    throw py::type_error("UYVY is bytes or an array of uint8, not " +
                         text_of(py::type::handle_of(data).attr("__name__")));
  const py::array array = py::module_::import("numpy").attr("asarray")(
      py::isinstance<py::array>(data) ? data : py::memoryview{data});
  if (array.dtype().kind() != 'u' || array.itemsize() != 1)
    throw py::type_error("UYVY of " + text_of(array.dtype()) + ", must be uint8");
  const std::size_t wanted = image_bytes(PixelFormat::kUyvy, width, height);
  if (static_cast<std::size_t>(array.size()) != wanted)
    throw std::runtime_error("UYVY of " + std::to_string(array.size()) + " bytes, must be " +
                             std::to_string(wanted) + ": " + std::to_string(width) + " x " +
                             std::to_string(height) + " stored pixels");
  const Bytes bytes = array;
  return {.owner = bytes,
          .bytes = bytes.data(),
          .format = PixelFormat::kUyvy,
          .stored_width = width,
          .stored_height = height,
          .rotation_deg = rotation};
}

/// Upright pixels, (height, width, 3): what `pixel` makes of the three of each.
template <class Pixel>
Bytes pixels(const Image& image, Pixel pixel) {
  Bytes array({image.height(), image.width(), 3});
  std::uint8_t* to = array.mutable_data();
  for (int v = 0; v < image.height(); ++v)
    image.visit_row(0, v, 1, image.width(), [&](Yuv color) {
      pixel(color, to);
      to += 3;
    });
  return array;
}

void keep(Yuv color, std::uint8_t* to) { to[0] = color.y, to[1] = color.u, to[2] = color.v; }

/// JFIF 1.02, back.
void to_rgb(Yuv color, std::uint8_t* to) {
  const double u = color.u - 128.0, v = color.v - 128.0;
  const auto part = [](double x) {
    return static_cast<std::uint8_t>(std::lround(std::clamp(x, 0.0, 255.0)));
  };
  to[0] = part(color.y + 1.402 * v);
  to[1] = part(color.y - 0.344136 * u - 0.714136 * v);
  to[2] = part(color.y + 1.772 * u);
}

Bytes rgb(const Picture& picture) {
  if (picture.format != PixelFormat::kRgb) return pixels(picture.view(), to_rgb);
  // As three bytes that mean nothing else, so that they stay as they are.
  return pixels(Image{picture.bytes, PixelFormat::kYuv444, picture.stored_width,
                      picture.stored_height, picture.rotation_deg},
                keep);
}

const char* name_of(PixelFormat format) {
  return format == PixelFormat::kUyvy ? "uyvy" : format == PixelFormat::kRgb ? "rgb" : "yuv444";
}

}  // namespace

Picture picture_of(const py::object& image) {
  if (py::isinstance<Picture>(image)) return image.cast<Picture>();
  return picture_in(image, PixelFormat::kRgb, 0);
}

Picture copied_picture(const void* bytes, PixelFormat format, int stored_width, int stored_height,
                       int rotation_deg) {
  const std::size_t size = image_bytes(format, stored_width, stored_height);
  const Bytes array(static_cast<py::ssize_t>(size), static_cast<const std::uint8_t*>(bytes));
  return {array, array.data(), format, stored_width, stored_height, rotation_deg};
}

Picture read_picture(const py::object& path, const config::Config& config) {
  const std::string name = path_of(path, "path");
  const files::ImageFile file =
      files::read_image(name, config.camera.stored_width(), config.camera.stored_height());
  const int rotation = tasks::Upright{config}.rotation_deg(file, name);
  return copied_picture(file.bytes.data(), file.format, file.stored_width, file.stored_height,
                        rotation);
}

void bind_picture(py::module_& m) {
  py::class_<Picture>(
      m, "Image",
      "A picture as the detector takes it: upright, whichever way it is stored.\n\n"
      "Made by read_image() or by one of the from_... functions. What is contiguous "
      "is looked at in\nplace: a later change of the array changes the picture.")
      .def_static(
          "from_rgb",
          [](const py::object& array, int rotation) {
            return picture_in(array, PixelFormat::kRgb, rotation);
          },
          "Of an RGB array (height, width, 3) of uint8. rotation: how far the stored picture has "
          "to be turned\ncounter-clockwise to be upright: 0, 90, 180, 270.",
          py::arg("array"), py::arg("rotation") = 0)
      .def_static(
          "from_yuv",
          [](const py::object& array, int rotation) {
            return picture_in(array, PixelFormat::kYuv444, rotation);
          },
          "Of an array (height, width, 3) of uint8: full-range Y, Cb, Cr, as in a JPEG.",
          py::arg("array"), py::arg("rotation") = 0)
      .def_static("from_uyvy", from_uyvy,
                  "Of raw UYVY: `width` x `height` stored pixels, as the Bebop's 160 x 315 with "
                  "rotation=90.",
                  py::arg("data"), py::arg("width"), py::arg("height"), py::arg("rotation") = 0)
      .def_property_readonly(
          "width", [](const Picture& p) { return p.view().width(); },
          "Of the upright picture [px].")
      .def_property_readonly(
          "height", [](const Picture& p) { return p.view().height(); },
          "Of the upright picture [px].")
      .def_property_readonly(
          "format", [](const Picture& p) { return name_of(p.format); },
          "How its bytes are laid out: 'rgb', 'yuv444' or 'uyvy'.")
      .def_readonly("rotation", &Picture::rotation_deg,
                    "How far the stored picture is turned counter-clockwise to be upright.")
      .def("rgb", rgb, "The upright picture as a new RGB array (height, width, 3) of uint8.")
      .def(
          "yuv", [](const Picture& p) { return pixels(p.view(), keep); },
          "The upright picture as a new array (height, width, 3) of uint8: full-range Y, Cb, Cr, "
          "what the\ndetector sees.")
      .def(
          "__array__",
          [](const Picture& p, const py::object& dtype, const py::object& copy) -> py::object {
            if (!copy.is_none() && !copy.cast<bool>())
              throw py::value_error("a gatefly.Image becomes an array by copying only");
            py::object array = rgb(p);
            return dtype.is_none() ? array : array.attr("astype")(dtype);
          },
          "rgb(), for numpy.asarray().", py::arg("dtype") = py::none(),
          py::arg("copy") = py::none())
      .def("__repr__", [](const Picture& p) {
        return "<gatefly.Image " + std::to_string(p.view().width()) + " x " +
               std::to_string(p.view().height()) + " px, " + name_of(p.format) + ">";
      });
  m.def(
      "read_image",
      [](const py::object& path, const py::object& rotation, const py::object& config,
         const py::object& settings) {
        tasks::ConfigArguments arguments = config_arguments(config, settings);
        if (!rotation.is_none()) {
          check_rotation(rotation.cast<int>());
          arguments.settings.push_back("camera.stored_rotation_deg=" + text_of(rotation));
        }
        return read_picture(path, tasks::load(arguments));
      },
      "The picture in a .jpg, .png, .ppm or raw .uyvy file, with the very bytes that `gatefly "
      "detect` looks at\n(a JPEG's Y'CbCr, not RGB made of it). Turned by `rotation`; where it is "
      "not given as the camera of a\nconfig says, else as EXIF says.",
      py::arg("path"), py::arg("rotation") = py::none(), py::arg("config") = py::none(),
      py::arg("settings") = py::none());
}

}  // namespace gatefly::python
