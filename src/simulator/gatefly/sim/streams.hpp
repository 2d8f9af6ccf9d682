// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string_view>

namespace gatefly::sim {

/// Every stream of random numbers, by the name that keys it: one a purpose. A name that ends in " "
/// is one stream for each thing, its number follows. A test asks that the code uses these and no
/// others, each in one place.
inline constexpr std::array kStreams{
    // what a seed draws once: drawn.cpp
    std::string_view{"gates"}, std::string_view{"light"}, std::string_view{"decoys"},
    std::string_view{"start"}, std::string_view{"camera"}, std::string_view{"vehicle"},
    std::string_view{"bias"}, std::string_view{"imbalance"}, std::string_view{"warming"},
    std::string_view{"wind level"}, std::string_view{"false gates"}, std::string_view{"colors"},
    std::string_view{"people"}, std::string_view{"jet"}, std::string_view{"shear"},
    std::string_view{"moved gate"},
    // tick by tick
    std::string_view{"imu"}, std::string_view{"imu rumble"}, std::string_view{"autopilot imu"},
    std::string_view{"sonar"}, std::string_view{"baro"}, std::string_view{"wind"},
    std::string_view{"wash"}, std::string_view{"camera schedule"},
    // ideal vision
    std::string_view{"ideal gate "}, std::string_view{"ideal aslant "},
    std::string_view{"ideal hidden "}, std::string_view{"ideal crooked "},
    std::string_view{"ideal two gates "}, std::string_view{"ideal decoy "},
    std::string_view{"ideal place "}, std::string_view{"ideal lower "},
    std::string_view{"ideal bars "}, std::string_view{"ideal right "},
    std::string_view{"ideal down "}, std::string_view{"ideal size "},
    std::string_view{"ideal false lower "}, std::string_view{"ideal false bars "},
    std::string_view{"ideal places"}, std::string_view{"ideal outliers "},
    std::string_view{"ideal corners "}, std::string_view{"ideal crooked side "},
    std::string_view{"ideal decoy corners "}, std::string_view{"ideal place corners "},
    std::string_view{"ideal parts "}, std::string_view{"ideal false lower where "},
    std::string_view{"ideal false bars where "}, std::string_view{"ideal cut "},
    std::string_view{"ideal cut corners "}, std::string_view{"ideal false cut "},
    std::string_view{"ideal false cut where "},
    // the rooms, the same for every seed
    std::string_view{"hall"}, std::string_view{"showroom"}, std::string_view{"dark hall"},
    std::string_view{"exhibition"},
    // poses and moments of `gatefly render`
    std::string_view{"poses"}, std::string_view{"pictures"}, std::string_view{"varied lamps"},
    std::string_view{"varied gates"}, std::string_view{"varied clutter"},
    std::string_view{"varied camera"}, std::string_view{"varied sensor"},
    std::string_view{"varied recording"}};

}  // namespace gatefly::sim
