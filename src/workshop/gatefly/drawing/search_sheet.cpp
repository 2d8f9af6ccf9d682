// SPDX-License-Identifier: Apache-2.0
#include "gatefly/drawing/search_sheet.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include "gatefly/drawing/annotate.hpp"
#include "gatefly/files/text.hpp"

namespace gatefly::drawing {
namespace {

constexpr double kPanel = 720.0;  // width of a panel [px]
constexpr double kGap = 16.0, kTop = 84.0, kCaption = 30.0, kRow = 24.0;

/// Place of a panel's picture, and how much it is enlarged.
struct Panel {
  Eigen::Vector2d at;
  double scale = 1.0;

  [[nodiscard]] Eigen::Vector2d operator()(const Eigen::Vector2d& p_px) const {
    return at + scale * (p_px + Eigen::Vector2d{0.5, 0.5});
  }
  [[nodiscard]] Quad operator()(Quad quad) const {
    for (auto& p : quad) p = (*this)(p);
    return quad;
  }
};

/// Pictures, their places, and what is written above each.
class Sheet {
 public:
  Sheet(const SearchSheet& what, const Image& image)
      : what_{what},
        image_{image},
        scale_{kPanel / image.width()},
        height_{std::round(scale_ * image.height())},
        canvas_(static_cast<int>(2 * kPanel + 3 * kGap),
                static_cast<int>(kTop + 2 * (height_ + kCaption + kGap) + kCaption +
                                 (static_cast<double>(what.listed.size()) + 1.5) * kRow),
                kDark.page) {}

  Canvas draw() && {
    canvas_.text({kGap, 34.0}, what_.title, {.color = kDark.ink, .size = 22.0, .bold = true});
    canvas_.text({kGap, 62.0}, what_.in_words, {.color = kDark.muted, .size = 16.0});
    answer(begin(0, 0, "what was answered"));
    evidence(begin(1, 0, "evidence: bright speaks for a bar of the gate's colour, dark against"));
    frames(begin(0, 1,
                 "careful search: " + files::amount(what_.trace.places.size(), "place") +
                     " tried (thin), frames as listed below"));
    bars(begin(1, 1,
               "fast search: " + files::amount(what_.bars.size(), "bar") + ", " +
                   files::amount(what_.fast.size(), "gate")));
    canvas_.unclip();
    list();
    return std::move(canvas_);
  }

 private:
  Panel begin(int column, int row, const std::string& caption) {
    const Eigen::Vector2d at{kGap + column * (kPanel + kGap),
                             kTop + row * (height_ + kCaption + kGap) + kCaption};
    if (clipped_) canvas_.unclip();
    clipped_ = true;
    canvas_.text(at - Eigen::Vector2d{0.0, 9.0}, caption, {.color = kDark.ink, .size = 15.0});
    canvas_.clip({at.x(), at.y(), kPanel, height_});
    return {at, scale_};
  }

  void picture(const Panel& panel, double dimmed) {
    canvas_.image(image_, panel.at, scale_);
    if (dimmed > 0.0)
      canvas_.fill({panel.at.x(), panel.at.y(), kPanel, height_}, kDark.page.faded(dimmed));
  }

  void answer(const Panel& panel) {
    picture(panel, 0.0);
    for (const GateDetection& gate : what_.found)
      draw_detection(canvas_, gate, panel.at, scale_, {.color = kDark.found, .width = 2.0});
    if (what_.found.empty()) plate("no gate", panel.at + Eigen::Vector2d{8.0, 26.0}, kDark.muted);
  }

  void evidence(const Panel& panel) {
    const EvidenceMap& map = what_.map;
    std::vector<std::uint8_t> rgb;
    for (int y = 0; y < map.height(); ++y)
      for (int x = 0; x < map.width(); ++x) {
        const double e = static_cast<double>(map.at(x, y)) / EvidenceMap::kLimit;
        // Grey in the middle; against: to blue-black, for: over orange to white.
        const auto mix = [&](double none, double full) {
          return static_cast<std::uint8_t>(std::lround(none + std::abs(e) * (full - none)));
        };
        if (e < 0.0)
          for (const double full : {6.0, 10.0, 28.0}) rgb.push_back(mix(70.0, full));
        else
          for (const double full : {255.0, 214.0, 120.0}) rgb.push_back(mix(70.0, full));
      }
    if (rgb.empty()) return;
    canvas_.image(Image{rgb.data(), PixelFormat::kRgb, map.width(), map.height(), 0}, panel.at,
                  scale_ * map.step());
  }

  void frames(const Panel& panel) {
    picture(panel, 0.45);
    for (const SearchTrace::Place& place : what_.trace.places)
      canvas_.outline(panel(place.template_px), {.color = kDark.muted.faded(0.35), .width = 0.8});
    for (std::size_t i = what_.listed.size(); i-- > 0;) {
      const ListedFrame& frame = what_.listed[i];
      const Color color = frame.taken ? kDark.good : kDark.bad;
      const Quad quad = panel(frame.bars_px);
      canvas_.outline(quad, {.color = color, .width = frame.taken ? 2.5 : 1.5});
      plate(std::to_string(i + 1), quad[0], color);
    }
  }

  void bars(const Panel& panel) {
    picture(panel, 0.45);
    for (const Bar& bar : what_.bars)
      canvas_.line(panel(bar.at(bar.top)), panel(bar.at(bar.bottom)),
                   {.color = kDark.gate, .width = std::clamp(0.02 * bar.strength, 1.5, 6.0)});
    for (const GateDetection& gate : what_.fast)
      draw_detection(canvas_, gate, panel.at, scale_, {.color = kDark.good, .width = 2.0});
  }

  void plate(const std::string& text, const Eigen::Vector2d& at, const Color& color) {
    const Lettering lettering{.color = kDark.page, .size = 13.0, .bold = true};
    canvas_.fill({at.x() - 3.0, at.y() - 15.0, canvas_.text_width(text, lettering) + 6.0, 18.0},
                 color, 3.0);
    canvas_.text({at.x(), at.y() - 1.0}, text, lettering);
  }

  void row(double y, const std::array<std::string, 10>& cells, const Color& color) {
    constexpr std::array kColumns{0.0, 30.0, 90.0, 150.0, 225.0, 290.0, 360.0, 435.0, 495.0, 565.0};
    for (std::size_t i = 0; i < cells.size(); ++i)
      canvas_.text({kGap + kColumns[i], y}, cells[i], {.color = color, .size = 15.0});
  }

  void list() {
    double y = kTop + 2 * (height_ + kCaption + kGap) + 0.5 * kCaption;
    row(y,
        {"", "score", "mean", "weakest", "inside", "outside", "beyond", "filled", "side px",
         "what became of it"},
        kDark.muted);
    for (std::size_t i = 0; i < what_.listed.size(); ++i) {
      const ListedFrame& frame = what_.listed[i];
      const FrameScore& s = frame.score;
      row(y += kRow,
          {std::to_string(i + 1), files::fixed(s.total, 2), files::fixed(s.mean, 2),
           files::fixed(s.weakest, 2), files::fixed(s.inside, 2), files::fixed(s.outside, 2),
           files::fixed(s.beyond, 2), files::fixed(s.filled, 2),
           files::fixed(std::sqrt(std::abs(area(frame.bars_px))), 0), frame.fate},
          frame.taken ? kDark.good : kDark.ink);
    }
  }

  const SearchSheet& what_;
  const Image& image_;
  double scale_, height_;
  bool clipped_ = false;
  Canvas canvas_;
};

}  // namespace

Canvas drawn(const SearchSheet& sheet, const Image& image) {
  if (image.empty()) throw std::runtime_error("the picture is empty");
  return Sheet(sheet, image).draw();
}

}  // namespace gatefly::drawing
