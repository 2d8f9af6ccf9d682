// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>

// JSON schemas of the messages of flight.mcap: Foxglove's well-known ones by their
// names, without their descriptions, and ours.
namespace gatefly::simulated_race::schema {

using Json = nlohmann::ordered_json;

[[nodiscard]] Json frame_transforms();   ///< foxglove.FrameTransforms
[[nodiscard]] Json pose_in_frame();      ///< foxglove.PoseInFrame
[[nodiscard]] Json compressed_image();   ///< foxglove.CompressedImage
[[nodiscard]] Json image_annotations();  ///< foxglove.ImageAnnotations
[[nodiscard]] Json scene_update();       ///< foxglove.SceneUpdate

[[nodiscard]] Json truth();       ///< gatefly.Truth
[[nodiscard]] Json estimate();    ///< gatefly.Estimate
[[nodiscard]] Json imu();         ///< gatefly.Imu
[[nodiscard]] Json detections();  ///< gatefly.Detections
[[nodiscard]] Json control();     ///< gatefly.Control

}  // namespace gatefly::simulated_race::schema
