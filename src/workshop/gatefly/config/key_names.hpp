// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace gatefly::config {

/// Every key that a configuration may set: "camera.tilt_deg", ..., [randomize]'s and [faults]' too.
[[nodiscard]] std::vector<std::string> key_names();

/// ", did you mean 'section.key'?" for a key that is not known: the keys of that name in other
/// sections; one that it begins, as "speed" does "speed_mps", in its section or in others; of a
/// like name in its section, or any like it. Else where they are listed.
[[nodiscard]] std::string key_suggestion(const std::string& name);

}  // namespace gatefly::config
