// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sim/showroom_palette.hpp"

namespace gatefly::sim {

ShowroomPalette::ShowroomPalette(SceneBuilder& b)
    : floor{b.material({.albedo = {0.30f, 0.32f, 0.31f},
                        .second = {0.265f, 0.29f, 0.28f},
                        .pattern = Pattern::kGrain,
                        .scale = 0.6f})},
      wall{b.matt({0.42f, 0.42f, 0.40f}, Pattern::kGrain, {0.34f, 0.34f, 0.33f}, 1.3)},
      ceiling{b.matt({0.34f, 0.34f, 0.33f}, Pattern::kBlocks, {0.26f, 0.26f, 0.26f}, 0.8)},
      beam{b.matt({0.13f, 0.13f, 0.13f})},
      pipe{b.matt({0.5f, 0.5f, 0.48f})},
      column{b.matt({0.55f, 0.55f, 0.52f}, Pattern::kGrain, {0.48f, 0.48f, 0.46f}, 3.0)},
      blue{b.matt({0.045f, 0.052f, 0.090f}, Pattern::kGrain, {0.055f, 0.062f, 0.105f}, 2.0)},
      shelf{b.matt({0.07f, 0.12f, 0.32f})},
      frame{b.matt({0.03f, 0.035f, 0.05f})},
      lamp{b.light({11.0f, 10.4f, 9.6f}, kCeilingLight)},
      strip{b.light({7.0f, 7.2f, 6.8f}, kShowcaseLight)},
      spot{b.light({30.0f, 26.0f, 20.0f}, kSpotLight)},
      silver{b.matt({0.72f, 0.72f, 0.72f}, Pattern::kBlocks, {0.38f, 0.38f, 0.40f}, 3.0)},
      skin{b.matt({0.66f, 0.66f, 0.62f}, Pattern::kTiles, {0.25f, 0.25f, 0.25f}, 1.6)},
      glass{b.matt({0.85f, 0.86f, 0.86f})},
      yellow{b.matt({0.44f, 0.35f, 0.13f})},
      green{b.matt({0.05f, 0.30f, 0.13f}, Pattern::kTiles, {0.02f, 0.10f, 0.05f}, 2.5)},
      carton{b.matt({0.36f, 0.25f, 0.15f}, Pattern::kTiles, {0.25f, 0.17f, 0.10f}, 1.5)},
      exit_sign{b.light({0.10f, 1.6f, 0.5f}, kSpotLight)} {
  const auto panel = [&](float red, float green_light, float blue_light, float scale,
                         Pattern pattern = Pattern::kGrain) {
    return b.material({.albedo = {0.5f, 0.5f, 0.5f},
                       .second = {0.4f, 0.4f, 0.4f},
                       .pattern = pattern,
                       .scale = scale,
                       .emission = {red, green_light, blue_light},
                       .group = kShowcaseLight});
  };
  glow = {panel(0.29f, 0.85f, 0.80f, 1.1f),  panel(0.20f, 0.55f, 0.52f, 1.4f),
          panel(0.15f, 0.26f, 0.255f, 1.7f), panel(0.25f, 0.70f, 0.66f, 0.9f),
          panel(0.09f, 0.14f, 0.14f, 2.0f),  panel(0.09f, 0.24f, 0.23f, 9.0f, Pattern::kBlocks)};
  things = {b.matt({0.60f, 0.58f, 0.50f}),
            b.matt({0.10f, 0.10f, 0.11f}),
            b.matt({0.33f, 0.30f, 0.24f}),
            b.matt({0.46f, 0.40f, 0.16f}),
            b.matt({0.30f, 0.33f, 0.34f}),
            b.matt({0.22f, 0.28f, 0.20f}),
            b.matt({0.45f, 0.45f, 0.45f}, Pattern::kBlocks, {0.08f, 0.08f, 0.09f}, 14.0),
            b.matt({0.04f, 0.04f, 0.05f}),
            b.matt({0.62f, 0.62f, 0.60f}),
            b.matt({0.30f, 0.17f, 0.11f}),
            b.matt({0.75f, 0.75f, 0.72f}, Pattern::kBlocks, {0.20f, 0.20f, 0.22f}, 30.0),
            b.matt({0.05f, 0.05f, 0.06f}, Pattern::kBlocks, {0.50f, 0.50f, 0.48f}, 22.0),
            b.matt({0.16f, 0.16f, 0.17f}),
            b.matt({0.30f, 0.13f, 0.08f})};
  woods = {b.matt({0.34f, 0.24f, 0.14f}, Pattern::kPlanks, {0.26f, 0.18f, 0.11f}, 8.0),
           b.matt({0.22f, 0.14f, 0.09f}, Pattern::kPlanks, {0.16f, 0.10f, 0.07f}, 9.0),
           b.matt({0.44f, 0.38f, 0.28f}, Pattern::kGrain, {0.36f, 0.31f, 0.23f}, 6.0)};
  posters = {b.matt({0.55f, 0.55f, 0.50f}, Pattern::kBlocks, {0.18f, 0.22f, 0.25f}, 7.0),
             b.matt({0.30f, 0.19f, 0.16f}, Pattern::kBlocks, {0.45f, 0.43f, 0.38f}, 5.0),
             b.matt({0.07f, 0.26f, 0.15f}, Pattern::kBlocks, {0.40f, 0.42f, 0.38f}, 4.0),
             b.matt({0.08f, 0.09f, 0.11f}, Pattern::kBlocks, {0.30f, 0.32f, 0.33f}, 9.0),
             b.matt({0.62f, 0.61f, 0.58f}, Pattern::kBlocks, {0.12f, 0.12f, 0.13f}, 16.0)};
  // As the real ones: worn and dusty. Clean paint would stand out more than the gates do.
  warm = {b.matt({0.44f, 0.20f, 0.09f}), b.matt({0.30f, 0.08f, 0.06f}),
          b.matt({0.44f, 0.30f, 0.27f}),
          b.matt({0.26f, 0.13f, 0.07f}, Pattern::kPlanks, {0.19f, 0.09f, 0.05f}, 6.0),
          b.matt({0.34f, 0.13f, 0.10f}, Pattern::kBlocks, {0.50f, 0.46f, 0.42f}, 8.0)};
  fabrics = {b.matt({0.05f, 0.06f, 0.10f}), b.matt({0.13f, 0.12f, 0.12f}),
             b.matt({0.30f, 0.09f, 0.08f})};
}

}  // namespace gatefly::sim
