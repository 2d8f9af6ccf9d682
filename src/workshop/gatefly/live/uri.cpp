// SPDX-License-Identifier: Apache-2.0
#include "gatefly/live/uri.hpp"

#include <algorithm>
#include <charconv>
#include <map>
#include <stdexcept>
#include <string_view>

#include "gatefly/files/text.hpp"

namespace gatefly::live {
namespace {

/// A URI of a flag, taken apart from the front; errors name both.
class UriText {
 public:
  UriText(const char* flag, const std::string& text) : flag_{flag}, text_{text}, rest_{text_} {}

  [[noreturn]] void fail(const std::string& why) const {
    throw std::runtime_error(std::string{flag_} + " " + files::one_line(text_) + ": " + why);
  }
  /// Whether it goes on with `word`, which is then taken.
  bool takes(std::string_view word) {
    if (!rest_.starts_with(word)) return false;
    rest_.remove_prefix(word.size());
    return true;
  }
  /// Takes "?key=value&…" from its end.
  void take_options() {
    const auto mark = rest_.rfind('?');
    if (mark == std::string_view::npos) return;
    std::string_view options = rest_.substr(mark + 1);
    rest_ = rest_.substr(0, mark);
    while (!options.empty()) {
      const std::string_view option = options.substr(0, options.find('&'));
      options.remove_prefix(std::min(options.size(), option.size() + 1));
      const auto equals = option.find('=');
      if (equals == std::string_view::npos || equals == 0)
        fail("'" + std::string{option} + "' behind '?', must be KEY=VALUE");
      options_[std::string{option.substr(0, equals)}] = option.substr(equals + 1);
    }
  }
  std::string option(const std::string& key, const std::string& fallback) {
    const auto found = options_.find(key);
    if (found == options_.end()) return fallback;
    const std::string value = found->second;
    options_.erase(found);
    return value;
  }
  template <class Number>
  Number number(const std::string& name, std::string_view value, Number low, Number high) const {
    Number result{};
    const char* const end = value.data() + value.size();
    const auto [rest, error] = std::from_chars(value.data(), end, result);
    if (error != std::errc{} || rest != end || !(result >= low && result <= high))
      fail(name + " = '" + files::one_line(std::string{value}) + "', must be in " +
           files::text_of(static_cast<double>(low)) + ".." +
           files::text_of(static_cast<double>(high)));
    return result;
  }
  void refuse_other_options() const {
    if (!options_.empty()) fail("there is no option '" + options_.begin()->first + "'");
  }
  [[nodiscard]] bool at_end() const { return rest_.empty(); }
  [[nodiscard]] std::string rest(const char* what) const {
    if (rest_.empty()) fail(std::string{"names no "} + what);
    return std::string{rest_};
  }

 private:
  const char* flag_;
  std::string text_;
  std::string_view rest_;
  std::map<std::string, std::string> options_;
};

constexpr int kMostPort = 65535;
constexpr int kBetaflightSitl = 5761;  ///< The first serial line of Betaflight's simulator target.
/// The streams requested of an ArduCopter take 12,000 bytes a second, and it sends others unasked.
constexpr int kLeastMavlinkBaud = 230400;

}  // namespace

LinkUri link_uri(const std::string& text) {
  UriText uri{"--link", text};
  LinkUri link;
  link.mavlink = uri.takes("mavlink:");
  const std::string forms = link.mavlink
                                ? "mavlink:serial:/dev/ttyX?baud=921600, mavlink:tcp:HOST:PORT, "
                                  "mavlink:udp:HOST:PORT or mavlink:udpin:ADDRESS:PORT"
                                : "msp:/dev/ttyX?baud=115200 or msp:tcp:HOST:PORT";
  if (!link.mavlink && uri.takes("betaflight-sitl:")) {
    link.place = "127.0.0.1";
    link.port = uri.at_end() ? kBetaflightSitl : uri.number("PORT", uri.rest("port"), 1, kMostPort);
    return link;
  }
  if (!link.mavlink && uri.takes("replay:")) {
    uri.take_options();
    link.kind = LinkUri::Kind::kReplay;
    link.place = uri.rest("folder");
    link.pace = uri.number("pace", uri.option("pace", "1"), 0.0, 100.0);
    uri.refuse_other_options();
    return link;
  }
  if (!link.mavlink && !uri.takes("msp:"))
    uri.fail("must begin with msp: (" + forms + "), betaflight-sitl:, mavlink: or replay:");
  uri.take_options();
  if (uri.takes("tcp:"))
    link.kind = LinkUri::Kind::kTcp;
  else if (link.mavlink && uri.takes("udp:"))
    link.kind = LinkUri::Kind::kUdp;
  else if (link.mavlink && uri.takes("udpin:"))
    link.kind = LinkUri::Kind::kUdpIn;
  else
    link.kind = LinkUri::Kind::kSerial;
  if (link.kind == LinkUri::Kind::kSerial) {
    if (link.mavlink && !uri.takes("serial:")) uri.fail("must be " + forms);
    link.place = uri.rest("device");
    if (!link.place.starts_with('/')) uri.fail("must be " + forms);
    link.baud =
        uri.number("baud", uri.option("baud", link.mavlink ? "921600" : "115200"), 1, 10'000'000);
    if (link.mavlink && link.baud < kLeastMavlinkBaud)
      uri.fail("baud = " + std::to_string(link.baud) +
               " is too slow for what an ArduCopter sends, and all of it would come later and "
               "later; at least " +
               std::to_string(kLeastMavlinkBaud) + ", 921600 when none is named");
  } else {
    const std::string place = uri.rest("host");
    const auto colon = place.rfind(':');
    if (colon == std::string::npos || colon == 0) uri.fail("must be " + forms);
    link.place = place.substr(0, colon);
    link.port = uri.number("PORT", std::string_view{place}.substr(colon + 1), 1, kMostPort);
  }
  if (link.kind == LinkUri::Kind::kUdp) link.bind = uri.option("bind", link.bind);
  if (link.kind == LinkUri::Kind::kUdpIn) link.peer = uri.option("peer", link.peer);
  if (link.mavlink) link.system = uri.number("system", uri.option("system", "1"), 1, 254);
  uri.refuse_other_options();
  return link;
}

CameraUri camera_uri(const std::string& text) {
  UriText uri{"--camera", text};
  CameraUri camera;
  if (uri.takes("file:")) {
    camera.kind = CameraUri::Kind::kFolder;
    camera.place = uri.rest("folder");
  } else if (uri.takes("udp-jpeg:")) {
    uri.take_options();
    camera.kind = CameraUri::Kind::kSlices;
    camera.port = uri.number("PORT", uri.rest("port"), 1, kMostPort);
    camera.bind = uri.option("bind", camera.bind);
    camera.peer = uri.option("peer", camera.peer);
    uri.refuse_other_options();
  } else if (uri.takes("v4l2:")) {
    camera.kind = CameraUri::Kind::kStream;
    const std::string device = uri.rest("device");
    if (!device.starts_with("/dev/")) uri.fail("must be v4l2:/dev/videoN");
    camera.place = "v4l2src device=" + device;
  } else if (uri.takes("gst:")) {
    camera.kind = CameraUri::Kind::kStream;
    camera.place = uri.rest("pipeline");
  } else {
    uri.fail("must begin with v4l2:, gst:, udp-jpeg: or file:");
  }
  return camera;
}

}  // namespace gatefly::live
