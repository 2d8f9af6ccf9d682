// SPDX-License-Identifier: Apache-2.0
// Any bytes are a picture: size, layout, background, then things drawn on it. Every detector has to
// live with it.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "support/all_detectors.hpp"

namespace {

using namespace gatefly;

/// The input, byte by byte; zeros after its end.
class Bytes {
 public:
  Bytes(const std::uint8_t* data, std::size_t size) : data_{data}, left_{size} {}
  int next() { return left_ > 0 ? (--left_, *data_++) : 0; }
  [[nodiscard]] bool more() const { return left_ > 0; }

 private:
  const std::uint8_t* data_;
  std::size_t left_;
};

/// A stored picture of any layout; what is drawn is not careful about colour subsampling.
struct Drawing {
  PixelFormat format;
  int width, height;
  std::vector<std::uint8_t> bytes;

  void set(int x, int y, Yuv c) {
    if (x < 0 || y < 0 || x >= width || y >= height) return;
    const auto pixel =
        static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
    if (format == PixelFormat::kUyvy) {
      bytes[2 * pixel + 1] = c.y, bytes[2 * pixel] = (x % 2 == 0) ? c.u : c.v;
    } else {
      bytes[3 * pixel] = c.y, bytes[3 * pixel + 1] = c.u, bytes[3 * pixel + 2] = c.v;
    }
  }
  void frame(int x, int y, int w, int h, int bar, int lean, Yuv c) {
    for (int j = 0; j < h; ++j)
      for (int i = 0; i < w; ++i)
        if (i < bar || j < bar || i >= w - bar || j >= h - bar)
          set(x + i + lean * j / 16, y + j, c);
  }
};

Yuv color_of(int choice) {
  constexpr std::array<Yuv, 6> kColors{{{130, 80, 185},
                                        {120, 90, 150},
                                        {250, 120, 136},
                                        {60, 110, 150},
                                        {128, 128, 128},
                                        {0, 255, 255}}};
  return kColors[static_cast<std::size_t>(choice) % kColors.size()];
}

Drawing drawing_of(Bytes& in) {
  const int layout = in.next();
  // small: sanitizers are slow
  Drawing d{static_cast<PixelFormat>(layout % 3), in.next(), in.next() / 2, {}};
  if (layout >= 240) d.width *= 16, d.height %= 24;
  if (layout >= 248) std::swap(d.width, d.height);
  d.bytes.resize(3 * static_cast<std::size_t>(d.width) * static_cast<std::size_t>(d.height));
  // Background: plain, or noise of some strength.
  const Yuv base = color_of(in.next());
  const int noise = in.next() % 64;
  Rng rng{static_cast<std::uint64_t>(in.next())};
  for (int y = 0; y < d.height; ++y)
    for (int x = 0; x < d.width; ++x) {
      const auto around = [&](int c) {
        return static_cast<std::uint8_t>(
            std::clamp(c + rng.uniform_index(2 * noise + 1) - noise, 0, 255));
      };
      d.set(x, y, noise == 0 ? base : Yuv{around(base.y), around(base.u), around(base.v)});
    }
  return d;
}

gatefly::test::DetectorSettings settings_of(Bytes& in) {
  static const gatefly::test::DetectorSettings defaults;
  gatefly::test::DetectorSettings s = defaults;
  const auto one_of = [&](std::initializer_list<double> values) {
    return values.begin()[static_cast<std::size_t>(in.next()) % values.size()];
  };
  // The ends of what a configuration allows.
  s.search.max_roll_deg = one_of({60, 0, 9, 90});
  s.search.min_side_px = one_of({10, 1, 500});
  s.search.min_score = one_of({2.5, -5, 10});
  s.search.max_aspect = one_of({3.2, 1, 20});
  s.search.bar_ratio = one_of({0.05, 0.002, 0.45});
  s.search.corner_scale = one_of({1.05, 0.1, 2.0});
  s.search.max_inside = one_of({0.5, -3, 3});
  s.search.sure_score = one_of({3.5, -5, 20});
  const double corner = in.next();
  if (in.next() % 4 == 0)
    s.previous = Quad{{{0, 0}, {corner, 0}, {corner, corner}, {0, 2 * corner}}};
  return s;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Bytes in{data, size};
  const int turn = 90 * (in.next() % 5);
  Drawing drawing = drawing_of(in);
  const auto settings = settings_of(in);
  for (int things = 0; in.more() && things < 12; ++things) {
    const Yuv color = color_of(in.next());
    const int x = in.next() - 32, y = in.next() - 32, w = in.next(), h = in.next(),
              shape = in.next();
    drawing.frame(x, y, w, h, 1 + shape % 16, shape / 16 - 8, color);
  }
  // An allocation of exactly its bytes, so that a sanitizer sees the first one too many.
  drawing.bytes.resize(image_bytes(drawing.format, drawing.width, drawing.height));
  const std::vector<std::uint8_t> exact(drawing.bytes);
  const Image image{exact.data(), drawing.format, drawing.width, drawing.height, turn};
  const std::string complaint = gatefly::test::AllDetectors{}.complaint(image, settings);
  if (!complaint.empty()) {
    std::fprintf(stderr, "detection_fuzz: %s\n", complaint.c_str());
    std::abort();
  }
  return 0;
}
