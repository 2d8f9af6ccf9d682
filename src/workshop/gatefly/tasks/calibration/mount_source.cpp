// SPDX-License-Identifier: Apache-2.0
#include "gatefly/tasks/calibration/mount_source.hpp"

#include <vector>

#include "gatefly/files/text.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/tasks/calibration/with_sigma.hpp"

namespace gatefly::calibration {
namespace {

namespace fs = std::filesystem;
using files::fixed;

/// The gate of each picture that has exactly one.
std::vector<Quad> single_gates(const files::Labels& labels) {
  std::vector<Quad> gates;
  for (const files::LabelledPicture& picture : labels.pictures)
    if (picture.gates.size() == 1) gates.push_back(picture.gates[0]);
  return gates;
}

/// Parameters that were fitted along with the mount, in words.
std::string fitted_with_it(const Mount& mount) {
  return "; fitted with it: heading offset " + fixed(mount.heading_offset / kDegree, 1) +
         " deg, pictures " + fixed(1e3 * mount.time_offset, 0) + " ms, gate at (" +
         fixed(mount.p_EG.x(), 2) + ", " + fixed(mount.p_EG.y(), 2) + ", " +
         fixed(mount.p_EG.z(), 2) + ") m.";
}

}  // namespace

files::Labels gate_labels(const fs::path& path) {
  return files::read_labels(fs::is_directory(path) ? path / "labels.csv" : path);
}

FoundMount mount_from(const fs::path& path, const files::Labels& labels, const AnyCamera& lens,
                      const MountArguments& arguments) {
  const bool flight = fs::is_directory(path);
  return {.mount = flight ? mount_from_flight(flight_log::read_flight_folder(path), labels, lens,
                                              arguments.gate_side, arguments.p_BC)
                          : mount_from_level(single_gates(labels), lens, arguments.gate_side,
                                             arguments.gate_height),
          .from = path.filename().string(),
          .flight = flight};
}

std::string text_of(const FoundMount& found) {
  const Mount& mount = found.mount;
  return "Tilt " + with_sigma(mount.tilt_down / kDegree, mount.tilt_sigma / kDegree) +
         " deg down, roll " + with_sigma(mount.roll / kDegree, mount.roll_sigma / kDegree) +
         " deg, from " + files::amount(mount.pictures, "picture") + " of a gate (" + found.from +
         "), RMS " + fixed(mount.rms_px, 2) + " px" +
         (found.flight ? fitted_with_it(mount)
                       : "; a drone that stood askew by a degree makes it a degree.");
}

}  // namespace gatefly::calibration
