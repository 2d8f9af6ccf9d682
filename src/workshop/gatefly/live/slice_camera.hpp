// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "gatefly/link/jpeg_slices.hpp"
#include "gatefly/live/camera.hpp"
#include "gatefly/live/port.hpp"
#include "gatefly/live/stamped_arrivals.hpp"

namespace gatefly::live {

/// JPEG slices over UDP: link/jpeg_slices.
class SliceCamera : public Camera {
 public:
  SliceCamera(Port port, StoredSize size);
  Got next(Picture& picture, Moment deadline) override;

 private:
  Port port_;
  StoredSize size_;
  jpeg_slices::Assembler assembler_;
  StampedArrivals stamps_;
  std::vector<std::uint8_t> room_;
  std::size_t count_ = 0;
  std::uint64_t begun_ = 0;
};

}  // namespace gatefly::live
