// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sim/shading.hpp"

#include <algorithm>
#include <array>
#include <string>

#include "gatefly/geometry/math.hpp"
#include "gatefly/sim/random.hpp"

namespace gatefly::sim {
namespace {

unsigned scrambled(unsigned x) {
  x = (x ^ (x >> 16)) * 0x7feb352du;
  x = (x ^ (x >> 15)) * 0x846ca68bu;
  return x ^ (x >> 16);
}

Float4 to_float4(const Color& c) { return Float4{c[0], c[1], c[2], 0.0f}; }

Float4 with_gains(const NodeLight& node, const world::LightConditions& light) {
  Color sum{};
  for (std::size_t group = 0; group < light.group_gain.size(); ++group)
    for (std::size_t c = 0; c < 3; ++c)
      sum[c] += static_cast<float>(light.group_gain[group] * light.group_color[group][c] / kPi) *
                node[3 * group + c];
  return to_float4(sum);
}

Float4 emission_of(const Material& m, const world::LightConditions& light) {
  const auto group = static_cast<std::size_t>(m.group);
  Color emission = m.emission;
  for (std::size_t c = 0; c < 3; ++c)
    emission[c] *= static_cast<float>(light.group_gain[group] * light.group_color[group][c]);
  return to_float4(emission);
}

Color times(const Color& color, double factor, const std::array<double, 3>& tint) {
  Color result;
  for (std::size_t c = 0; c < 3; ++c)
    result[c] = std::clamp(static_cast<float>(factor * tint[c]) * color[c], 0.01f, 0.9f);
  return result;
}

/// The same surface in another room: lighter or darker by up to a factor of two, tinted by up to
/// 20 %, with other contrasts; a third of the plain ones get a pattern. Each material's draws are
/// its own.
Material redecorated(const Material& m, std::size_t number, std::uint64_t seed) {
  Stream stream{seed, "surface " + std::to_string(number)};
  const auto factor = [&] {
    const double x = stream.uniform();
    return 0.5 + 0.5 * x + x * x;  // 0.5 .. 2
  };
  const auto tint = [&] {
    return std::array{stream.uniform(0.8, 1.2), stream.uniform(0.8, 1.2), stream.uniform(0.8, 1.2)};
  };
  Material other = m;
  const double scale = stream.uniform(0.5, 2.0), chance = stream.uniform(),
               cells = stream.uniform(0.5, 6.0);
  const double first = factor(), second = factor();
  const auto first_tint = tint(), second_tint = tint();
  other.albedo = times(m.albedo, first, first_tint);
  other.second = times(m.pattern == Pattern::kPlain ? other.albedo : m.second, second, second_tint);
  other.scale = static_cast<float>(scale) * m.scale;
  if (m.pattern != Pattern::kPlain || chance > 1.0 / 3) return other;
  constexpr std::array kPatterns{Pattern::kGrain, Pattern::kTiles, Pattern::kPlanks,
                                 Pattern::kBlocks};
  other.pattern = kPatterns[std::min(static_cast<std::size_t>(12 * chance), kPatterns.size() - 1)];
  other.scale = static_cast<float>(cells);
  return other;
}

}  // namespace

Shader::Shader(const Scene& scene, const LightMap& fixed, const LightMap& moved,
               const world::LightConditions& light) {
  for (unsigned i = 0; i < noise_.size(); ++i)
    noise_[i] = static_cast<float>(scrambled(i * 0x9E3779B9u + 1) >> 8) * 0x1p-24f;
  append(scene, scene.fixed, fixed, light);
  append(scene, scene.moved, moved, light);
}

void Shader::append(const Scene& scene, const std::vector<Rectangle>& rectangles,
                    const LightMap& map, const world::LightConditions& light) {
  const int before = static_cast<int>(nodes_.size());
  for (const NodeLight& node : map.nodes) nodes_.push_back(with_gains(node, light));
  for (const Rectangle& r : rectangles) {
    const auto number = static_cast<std::size_t>(r.material);
    const Material& nominal = scene.materials[number];
    const bool changed = light.surfaces != 0 && &rectangles == &scene.fixed;
    const Material m = changed ? redecorated(nominal, number, light.surfaces) : nominal;
    Surface s{};
    s.albedo = to_float4(m.albedo);
    s.to_second = to_float4(m.second) - s.albedo;
    s.emission = emission_of(m, light);
    s.pattern_u = r.length.x() * m.scale;
    s.pattern_v = r.length.y() * m.scale;
    s.cells_u = static_cast<float>(r.cells_u);
    s.cells_v = static_cast<float>(r.cells_v);
    s.last_u = r.cells_u - 1;
    s.last_v = r.cells_v - 1;
    s.first_node = before + r.first_node;
    s.row = r.cells_u + 1;
    s.salt = scrambled(static_cast<unsigned>(surfaces_.size())) % kNoise;
    s.pattern = m.pattern;
    surfaces_.push_back(s);
  }
}

float Shader::second_share(const Surface& s, float u, float v) const {
  const float x = u * s.pattern_u, y = v * s.pattern_v;
  const auto i = static_cast<unsigned>(x), j = static_cast<unsigned>(y);
  switch (s.pattern) {
    case Pattern::kPlain:
      return 0.0f;
    case Pattern::kGrain: {
      const float fx = x - static_cast<float>(i), fy = y - static_cast<float>(j);
      const unsigned a = i + s.salt;
      const float top = noise(a, j) + fx * (noise(a + 1, j) - noise(a, j));
      const float low = noise(a, j + 1) + fx * (noise(a + 1, j + 1) - noise(a, j + 1));
      return top + fy * (low - top);
    }
    case Pattern::kTiles: {
      const float fx = x - static_cast<float>(i), fy = y - static_cast<float>(j);
      return fx < 0.05f || fy < 0.05f ? 1.0f : 0.0f;
    }
    case Pattern::kPlanks:
      return noise(s.salt, j);
    case Pattern::kBlocks:
      return noise(i + s.salt, j) > 0.5f ? 1.0f : 0.3f * noise(i, j + s.salt);
  }
  return 0.0f;
}

inline Float4 Shader::light(const Surface& s, float u, float v) const {
  const float x = u * s.cells_u, y = v * s.cells_v;
  const int i = std::min(static_cast<int>(x), s.last_u),
            j = std::min(static_cast<int>(y), s.last_v);
  const float fx = x - static_cast<float>(i), fy = y - static_cast<float>(j);
  const Float4* node = nodes_.data() + s.first_node + j * s.row + i;
  const Float4 top = node[0] + fx * (node[1] - node[0]);
  const Float4 low = node[s.row] + fx * (node[s.row + 1] - node[s.row]);
  return top + fy * (low - top);
}

Float4 Shader::radiance(unsigned rectangle, float u, float v) const {
  const Surface& s = surfaces_[rectangle];
  const Float4 light_here = light(s, std::max(u, 0.0f), std::max(v, 0.0f));
  if (s.pattern == Pattern::kPlain) return s.emission + s.albedo * light_here;
  const float share = second_share(s, std::max(u, 0.0f), std::max(v, 0.0f));
  return (0.5f + share) * s.emission + (s.albedo + share * s.to_second) * light_here;
}

Float4 Shader::radiance(const RayTile& rays, int group, int lane, int samples) const {
  constexpr int kLanes = RayTile::kLanes;
  const int first = group * kLanes + lane, end = first + samples * kLanes;
  const float each = 1.0f / static_cast<float>(samples);
  const int hit = rays.hit[first];
  if (samples == 1)
    return hit < 0 ? Float4{} : radiance(static_cast<unsigned>(hit), rays.u[first], rays.v[first]);
  bool same = true;
  float u = 0.0f, v = 0.0f;
  for (int i = first; i < end; i += kLanes)
    same = same && rays.hit[i] == hit, u += rays.u[i], v += rays.v[i];
  if (!same) {
    Float4 sum{};
    for (int i = first; i < end; i += kLanes)
      if (rays.hit[i] >= 0)
        sum += radiance(static_cast<unsigned>(rays.hit[i]), rays.u[i], rays.v[i]);
    return each * sum;
  }
  if (hit < 0) return Float4{};
  const Surface& s = surfaces_[static_cast<unsigned>(hit)];
  const Float4 light_here = light(s, std::max(each * u, 0.0f), std::max(each * v, 0.0f));
  if (s.pattern == Pattern::kPlain) return s.emission + s.albedo * light_here;
  float share = 0.0f;
  for (int i = first; i < end; i += kLanes)
    share += second_share(s, std::max(rays.u[i], 0.0f), std::max(rays.v[i], 0.0f));
  share *= each;
  return (0.5f + share) * s.emission + (s.albedo + share * s.to_second) * light_here;
}

}  // namespace gatefly::sim
