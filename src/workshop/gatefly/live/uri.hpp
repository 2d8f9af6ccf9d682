// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace gatefly::live {

/// The link that `--link` names.
struct LinkUri {
  enum class Kind {
    kSerial,  ///< msp:/dev/ttyTHS1?baud=115200
    kTcp,     ///< msp:tcp:127.0.0.1:5761; betaflight-sitl: is that one.
    kUdp,     ///< mavlink:udp:127.0.0.1:14550?bind=127.0.0.1: we call.
    kUdpIn,   ///< mavlink:udpin:127.0.0.1:14550?peer=127.0.0.1: it calls us.
    kReplay,  ///< replay:FOLDER?pace=1: a recorded flight's sensors in the place of a drone's.
  };
  Kind kind = Kind::kTcp;
  bool mavlink = false;         ///< Not MSP.
  std::string place;            ///< A device, host or folder.
  int port = 0, baud = 115200;  ///< Baud: MAVLink's default is 921600, its least 230400.
  std::string bind = "127.0.0.1", peer = "127.0.0.1";
  int system = 1;  ///< The MAVLink id of the drone that bench-drone asks; a flight's is its file's.
  double pace = 1.0;  ///< Speed of a replay relative to real time; 0: as fast as possible.
};

/// The camera that `--camera` names.
struct CameraUri {
  enum class Kind {
    kFolder,  ///< file:FOLDER: pictures of a recorded flight at their own pace.
    kSlices,  ///< udp-jpeg:5600?bind=127.0.0.1&peer=127.0.0.1: JPEG slices of TS-002.
    kStream,  ///< gst:PIPELINE or v4l2:/dev/video0: GStreamer, as a program beside ours.
  };
  Kind kind = Kind::kFolder;
  std::string place;  ///< A folder, or a GStreamer pipeline.
  int port = 0;
  std::string bind = "127.0.0.1", peer = "127.0.0.1";
};

/// @throws std::runtime_error one line: what is wrong, what is allowed.
[[nodiscard]] LinkUri link_uri(const std::string& text);
[[nodiscard]] CameraUri camera_uri(const std::string& text);

}  // namespace gatefly::live
