// SPDX-License-Identifier: Apache-2.0
#include "gatefly/files/image_file.hpp"

#include <algorithm>
#include <array>
#include <csetjmp>
#include <cstddef>
#include <cstdio>
#include <memory>
#include <new>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

#include <jpeglib.h>
#include <libexif/exif-data.h>
#include <png.h>

#include "gatefly/files/text.hpp"

namespace gatefly::files {
namespace {

constexpr int kLargestSide = 16384;  // [px]

// libjpeg leaves by longjmp. No object with a destructor may live in the frame that calls setjmp,
// and nothing that changes between setjmp and longjmp may be a local of it: all of that is in
// `Decoder`.
struct Decoder {
  jpeg_decompress_struct jpeg{};
  jpeg_error_mgr errors{};
  std::jmp_buf escape{};
  std::array<char, JMSG_LENGTH_MAX> message{};
  std::uint8_t* bytes = nullptr;  ///< The caller's, big enough after read_header.
};

[[noreturn]] void on_error(j_common_ptr common) {
  auto* decoder = static_cast<Decoder*>(common->client_data);
  common->err->format_message(common, decoder->message.data());
  std::longjmp(decoder->escape, 1);
}

// A warning means damaged data: libjpeg would go on with grey. We do not.
void on_message(j_common_ptr common, int level) {
  if (level < 0) on_error(common);
}

void on_output(j_common_ptr) {}

void start(Decoder& decoder, const std::string& file) {
  decoder.jpeg.err = jpeg_std_error(&decoder.errors);
  decoder.jpeg.client_data = &decoder;
  decoder.errors.error_exit = on_error;
  decoder.errors.emit_message = on_message;
  decoder.errors.output_message = on_output;
  jpeg_create_decompress(&decoder.jpeg);
  decoder.jpeg.client_data = &decoder;
  jpeg_mem_src(&decoder.jpeg, reinterpret_cast<const unsigned char*>(file.data()), file.size());
}

/// The orientation, 1..8, in an EXIF marker; 0: it has none.
int orientation_in(const std::uint8_t* marker, unsigned int size) {
  const auto release = [](ExifData* data) { exif_data_unref(data); };
  const std::unique_ptr<ExifData, decltype(release)> exif{exif_data_new(), release};
  if (!exif) throw std::bad_alloc{};
  // As it stands in the file: nothing that a specification would have there.
  exif_data_unset_option(exif.get(), EXIF_DATA_OPTION_FOLLOW_SPECIFICATION);
  exif_data_load_data(exif.get(), marker, size);
  const ExifEntry* entry = exif_content_get_entry(exif->ifd[EXIF_IFD_0], EXIF_TAG_ORIENTATION);
  if (entry == nullptr || entry->format != EXIF_FORMAT_SHORT || entry->size < 2) return 0;
  const int value = exif_get_short(entry->data, exif_data_get_byte_order(exif.get()));
  return value >= 1 && value <= 8 ? value : 0;
}

int exif_orientation(const jpeg_decompress_struct& jpeg) {
  constexpr std::string_view kStart{"Exif\0\0", 6};
  for (auto* marker = jpeg.marker_list; marker != nullptr; marker = marker->next)
    if (std::string_view{reinterpret_cast<const char*>(marker->data), marker->data_length}
            .starts_with(kStart))
      return orientation_in(marker->data, marker->data_length);
  return 0;
}

/// False with a message when libjpeg gives up.
bool read_header(Decoder& decoder, const std::string& file) {
  if (setjmp(decoder.escape) != 0) return false;
  start(decoder, file);
  jpeg_save_markers(&decoder.jpeg, JPEG_APP0 + 1, 0xFFFF);  // EXIF
  jpeg_read_header(&decoder.jpeg, TRUE);
  if (decoder.jpeg.jpeg_color_space != JCS_GRAYSCALE && decoder.jpeg.jpeg_color_space != JCS_RGB)
    decoder.jpeg.out_color_space = JCS_YCbCr;  // the others come as they are stored
  jpeg_calc_output_dimensions(&decoder.jpeg);
  return true;
}

bool read_lines(Decoder& decoder) {
  if (setjmp(decoder.escape) != 0) return false;
  jpeg_start_decompress(&decoder.jpeg);
  const std::size_t line_bytes = static_cast<std::size_t>(decoder.jpeg.output_width) *
                                 static_cast<std::size_t>(decoder.jpeg.output_components);
  while (decoder.jpeg.output_scanline < decoder.jpeg.output_height) {
    JSAMPROW line = decoder.bytes + decoder.jpeg.output_scanline * line_bytes;
    jpeg_read_scanlines(&decoder.jpeg, &line, 1);
  }
  jpeg_finish_decompress(&decoder.jpeg);
  return true;
}

/// Grey lines become Y, 128, 128.
std::vector<std::uint8_t> with_neutral_chroma(const std::vector<std::uint8_t>& grey) {
  std::vector<std::uint8_t> yuv(grey.size() * 3, 128);
  for (std::size_t i = 0; i < grey.size(); ++i) yuv[3 * i] = grey[i];
  return yuv;
}

ImageFile decode_png(const std::string& path, const std::string& file) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  struct Closer {
    png_image& png;
    ~Closer() { png_image_free(&png); }
  } closer{png};
  const auto fail = [&](const std::string& why) {
    throw std::runtime_error(path + ": not a usable PNG: " + why);
  };

  if (png_image_begin_read_from_memory(&png, file.data(), file.size()) == 0) fail(png.message);
  if (png.width > kLargestSide || png.height > kLargestSide) fail("it is larger than 16384 px");
  // grey, palettes, 16 bit become 8-bit RGB; what is transparent lies on black
  png.format = PNG_FORMAT_RGB;
  ImageFile image{.bytes = {},
                  .format = PixelFormat::kRgb,
                  .stored_width = static_cast<int>(png.width),
                  .stored_height = static_cast<int>(png.height)};
  image.bytes.resize(image_bytes(image.format, image.stored_width, image.stored_height));
  if (png_image_finish_read(&png, nullptr, image.bytes.data(), 0, nullptr) == 0) fail(png.message);
  return image;
}

/// The next word of a PPM header, after blanks and comments; nullopt when it is no number.
std::optional<int> ppm_number(const std::string& file, std::size_t& at) {
  while (at < file.size() &&
         (std::isspace(static_cast<unsigned char>(file[at])) || file[at] == '#')) {
    if (file[at] == '#') at = std::min(file.find('\n', at), file.size() - 1);
    ++at;
  }
  int number = 0;
  const std::size_t first = at;
  for (; at < file.size() && std::isdigit(static_cast<unsigned char>(file[at])) && at - first < 6;
       ++at)
    number = 10 * number + (file[at] - '0');
  return at > first ? std::optional{number} : std::nullopt;
}

ImageFile decode_ppm(const std::string& path, const std::string& file) {
  const auto fail = [&](const std::string& why) {
    throw std::runtime_error(path + ": not a usable PPM: " + why);
  };
  if (!file.starts_with("P6")) fail("it does not start with P6");
  std::size_t at = 2;
  const auto width = ppm_number(file, at), height = ppm_number(file, at),
             top = ppm_number(file, at);
  if (!width || !height || !top) fail("its header has no width, height and maximum");
  if (*width < 1 || *height < 1 || *width > kLargestSide || *height > kLargestSide)
    fail("its size must be in 1..16384 px");
  if (*top != 255) fail("its maximum must be 255");
  const std::size_t wanted = image_bytes(PixelFormat::kRgb, *width, *height);
  ++at;  // one blank ends the header
  if (file.size() < at + wanted) fail("it ends early");

  ImageFile image{
      .bytes = {}, .format = PixelFormat::kRgb, .stored_width = *width, .stored_height = *height};
  image.bytes.assign(file.begin() + static_cast<std::ptrdiff_t>(at),
                     file.begin() + static_cast<std::ptrdiff_t>(at + wanted));
  return image;
}

ImageFile decode_uyvy(const std::string& path, const std::string& file, int width, int height) {
  const std::size_t wanted = image_bytes(PixelFormat::kUyvy, width, height);
  if (wanted == 0 || width % 2 != 0)
    throw std::runtime_error(
        path + ": a .uyvy needs the camera's stored size, of even width (camera.size_px)");
  if (file.size() != wanted)
    throw std::runtime_error(path + ": has " + std::to_string(file.size()) + " bytes, must be " +
                             std::to_string(wanted) + ": " + std::to_string(width) + " x " +
                             std::to_string(height) + " stored pixels of UYVY");
  return {.bytes = {file.begin(), file.end()},
          .format = PixelFormat::kUyvy,
          .stored_width = width,
          .stored_height = height};
}

}  // namespace

std::optional<int> exif_rotation_deg(int orientation) {
  switch (orientation) {
    case 0:
    case 1:
      return 0;
    case 3:
      return 180;
    case 6:
      return 270;
    case 8:
      return 90;
    default:
      return std::nullopt;
  }
}

ImageFile decoded_jpeg(const std::string& name, const std::string& bytes) {
  Decoder decoder;
  struct Closer {
    Decoder& decoder;
    ~Closer() { jpeg_destroy_decompress(&decoder.jpeg); }
  } closer{decoder};
  const auto fail = [&](const std::string& why) {
    throw std::runtime_error(name + ": not a usable JPEG: " + why);
  };

  if (!read_header(decoder, bytes)) fail(decoder.message.data());
  const bool grey = decoder.jpeg.num_components == 1;
  if (!grey && decoder.jpeg.num_components != 3) fail("it has neither 1 nor 3 colour channels");
  ImageFile image;
  image.exif_orientation = exif_orientation(decoder.jpeg);
  if (decoder.jpeg.jpeg_color_space == JCS_RGB) image.format = PixelFormat::kRgb;
  image.stored_width = static_cast<int>(decoder.jpeg.output_width);
  image.stored_height = static_cast<int>(decoder.jpeg.output_height);
  if (image.stored_width > kLargestSide || image.stored_height > kLargestSide)
    fail("it is larger than 16384 px");
  image.bytes.resize(static_cast<std::size_t>(image.stored_width) *
                     static_cast<std::size_t>(image.stored_height) * (grey ? 1 : 3));
  decoder.bytes = image.bytes.data();
  if (!read_lines(decoder)) fail(decoder.message.data());
  if (grey) image.bytes = with_neutral_chroma(image.bytes);
  return image;
}

ImageFile read_image(const std::filesystem::path& path, int uyvy_width, int uyvy_height) {
  if (!is_picture(path))
    throw std::runtime_error(
        path.string() + ": not a picture: its name must end in .jpg, .jpeg, .png, .ppm or .uyvy");
  const std::string kind = kind_of(path), file = read_file(path);
  if (file.empty()) throw std::runtime_error(path.string() + ": is empty");
  if (kind == ".png") return decode_png(path.string(), file);
  if (kind == ".ppm") return decode_ppm(path.string(), file);
  if (kind == ".uyvy") return decode_uyvy(path.string(), file, uyvy_width, uyvy_height);
  return decoded_jpeg(path.string(), file);
}

}  // namespace gatefly::files
