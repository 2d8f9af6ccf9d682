// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sim/people.hpp"

#include <cmath>

namespace gatefly::sim {
namespace {

constexpr double kHalfWidth = 0.25;  // of a person [m]

}  // namespace

Eigen::Vector2d place_of(const world::Person& person, double t) {
  const Eigen::Vector2d way = person.to - person.from;
  const double length = way.norm();
  if (length <= 0.0) return person.from;
  const double walked = std::fmod(person.start + person.speed * t, 2 * length);
  return person.from + (walked < length ? walked : 2 * length - walked) / length * way;
}

std::optional<int> touched_person(std::span<const world::Person> people,
                                  const Eigen::Vector3d& p_EB, double radius, double t) {
  for (std::size_t i = 0; i < people.size(); ++i) {
    const double aside = (p_EB.head<2>() - place_of(people[i], t)).norm();
    if (aside < kHalfWidth + radius && -p_EB.z() < people[i].height + radius)
      return static_cast<int>(i);
  }
  return std::nullopt;
}

}  // namespace gatefly::sim
