/* SPDX-License-Identifier: Apache-2.0 */
/* As much of Paparazzi's and MAVLink's declarations as the examples of docs/in_your_autopilot.md call, so that a compiler reads these. */
#include <stddef.h>
#include <stdint.h>

struct Int32Vect3 {
  int32_t x, y, z;
};
struct Int32Rates {
  int32_t p, q, r;
};
#define ACCEL_FLOAT_OF_BFP(a) ((float)(a) / 1024.0f)
#define RATE_FLOAT_OF_BFP(a) ((float)(a) / 4096.0f)
enum image_type { IMAGE_YUV422, IMAGE_GRAYSCALE };
struct image_t {
  enum image_type type;
  uint16_t w, h;
  uint32_t pprz_ts, buf_size;
  void* buf;
};
typedef struct {
  int unused;
} abi_event;
struct video_config_t {
  int unused;
};
extern struct video_config_t front_camera;
#define ABI_BROADCAST 0
void AbiBindMsgIMU_GYRO(uint8_t id, abi_event* event,
                        void (*callback)(uint8_t, uint32_t, struct Int32Rates*));
void AbiBindMsgIMU_ACCEL(uint8_t id, abi_event* event,
                         void (*callback)(uint8_t, uint32_t, struct Int32Vect3*));
void AbiBindMsgAGL(uint8_t id, abi_event* event, void (*callback)(uint8_t, uint32_t, float));
void* cv_add_to_device(struct video_config_t* device,
                       struct image_t* (*function)(struct image_t*, uint8_t), uint16_t fps,
                       uint8_t id);
uint32_t get_sys_time_usec(void);
void cv_gatefly_init(void);

typedef struct {
  uint32_t msgid;
} mavlink_message_t;
typedef struct {
  uint64_t time_usec;
  float xacc, yacc, zacc, xgyro, ygyro, zgyro;
} mavlink_highres_imu_t;
enum { MAVLINK_MSG_ID_HIGHRES_IMU = 105, MAVLINK_COMM_0 = 0 };
void mavlink_msg_highres_imu_decode(const mavlink_message_t* message, mavlink_highres_imu_t* imu);
void mavlink_msg_set_attitude_target_send(int channel, uint32_t time_boot_ms, uint8_t system,
                                          uint8_t component, uint8_t mask, const float* q,
                                          float roll_rate, float pitch_rate, float yaw_rate,
                                          float thrust, const float* thrust_body);
