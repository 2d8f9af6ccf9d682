/* SPDX-License-Identifier: Apache-2.0 */
/* Included before everything on 64-bit ARM: the fused products that Eigen's kernel for matrices asks for by name, as a product
 * and a sum, rounded as everywhere else. */
#pragma once
#include <arm_neon.h>
#define vfmaq_n_f64(sum, a, b) ((sum) + (a)*vdupq_n_f64(b))
#define vfmaq_laneq_f64(sum, a, b, lane) ((sum) + (a)*vdupq_laneq_f64(b, lane))
#define vfmaq_n_f32(sum, a, b) ((sum) + (a)*vdupq_n_f32(b))
#define vfmaq_laneq_f32(sum, a, b, lane) ((sum) + (a)*vdupq_laneq_f32(b, lane))
