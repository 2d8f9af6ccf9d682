/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The pilot for programs in C: an autopilot's module, a companion's loop. C99 and C++.
 *
 *     gatefly_setup setup = {.struct_size = sizeof setup, .track = "oval"};
 *     gatefly_pilot* pilot = NULL;
 *     char error[GATEFLY_ERROR_SIZE];
 *     if (gatefly_create(NULL, 0, &setup, &pilot, error, sizeof error) != GATEFLY_OK) puts(error);
 *     for (;;) {
 *       ... gatefly_push_sonar, gatefly_push_image: what has arrived since the last step
 *       gatefly_step(pilot, time_us, gyro, accel, &command);    // once for each IMU sample
 *     }
 *
 * Units: SI and radians, unless a name says otherwise. Body axes x forward, y right, z down; earth
 * axes as the track file has them, z down; an IMU at rest reads (0, 0, -9.81) m/s^2. More:
 * docs/in_your_autopilot.md, docs/conventions.md.
 *
 * Time: every stamp is in microseconds of one clock, the IMU's, and may wrap (after 71.6 minutes).
 * There is no other clock in here.
 *
 * Memory: creation allocates; after it nothing does, locks or makes a system call. Threads: all calls of
 * one pilot from one thread, or never two at a time; pilots know nothing of each other.
 *
 * Versions: GATEFLY_ABI counts changes that old programs would not survive. Structures grow at
 * their end only; struct_size, which the caller sets, says which one it knows.
 */
#ifndef GATEFLY_H
#define GATEFLY_H

#include <stddef.h>
#include <stdint.h>

#define GATEFLY_ABI 1u          /**< To be compared with gatefly_abi(). */
#define GATEFLY_ERROR_SIZE 512u /**< Bytes that hold every text of gatefly_create(). */

#if defined(__GNUC__)
#define GATEFLY_API __attribute__((visibility("default")))
#else
#define GATEFLY_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/** What became of a call. Only GATEFLY_NULL ... GATEFLY_INTERNAL leave what they should write unwritten. */
typedef int32_t gatefly_status;
enum {
  GATEFLY_OK = 0,
  /* The pilot has got something that it cannot use; it goes on without. */
  GATEFLY_NOT_FINITE = 1,   /**< NaN or infinity among the numbers. */
  GATEFLY_OUT_OF_RANGE = 2, /**< No sensor reads this. */
  GATEFLY_STALE = 3, /**< Its stamp is that of an earlier one, before it, or far off the IMU's. */
  GATEFLY_WRONG_IMAGE = 4, /**< Not of the camera's size, or not as many bytes as its format has. */
  /* The call is wrong; nothing has happened. */
  GATEFLY_NULL = 16,           /**< A pointer is NULL, or to no pilot. */
  GATEFLY_WRONG_SIZE = 17,     /**< struct_size is of no version of that structure. */
  GATEFLY_NO_MEMORY = 18,      /**< The caller's memory is too small, or there is none left. */
  GATEFLY_WRONG_SETUP = 19,    /**< The configuration cannot be flown: the text says why. */
  GATEFLY_WRONG_ARGUMENT = 20, /**< A value that this function does not know. */
  GATEFLY_INTERNAL = 21        /**< Never, and if so a fault of this library. */
};

/** A pilot; only this library knows what is in it. */
typedef struct gatefly_pilot gatefly_pilot;

/** What a pilot is made of: files or texts as the program `gatefly` reads them, the later wins. */
typedef struct gatefly_setup {
  uint32_t struct_size;   /**< sizeof(gatefly_setup) */
  uint32_t config_count;  /**< Of configs. */
  uint32_t setting_count; /**< Of settings. */
  uint32_t reserved;      /**< 0 */
  const char* track;      /**< File, or name of a track that gatefly comes with; or NULL and ... */
  const char* track_text; /**< ... what would stand in that file. */
  const char* const*
      configs; /**< Camera, vehicle, settings: files, or names that gatefly comes with. */
  const char* config_text;     /**< The same as text, after them; may be NULL. */
  const char* const* settings; /**< "section.key=value", after all of it. */
} gatefly_setup;

/** What the drone does next; as Command in C++. Level and 0 while the motors are off. */
typedef struct gatefly_command {
  uint32_t struct_size;   /**< sizeof(gatefly_command), set by the caller. */
  uint32_t motors_off;    /**< 1: before take-off, after landing, or given up on the ground. */
  double roll_rad;        /**< > 0: right side down. */
  double pitch_rad;       /**< > 0: nose up. */
  double yaw_rad;         /**< > 0: clockwise seen from above. */
  double yaw_rate_radps;  /**< How fast yaw_rad itself moves. */
  double thrust_mps2;     /**< Thrust by mass along -z of the body; about 9.81 hovers. */
  double motors_radps[4]; /**< Left front, right front, right back, left back. */
  double rates_radps[3];  /**< With control.output for an autopilot: turn rates about x, y, z. */
} gatefly_command;

/** Where in its flight a pilot is: gatefly_state.phase. */
enum {
  GATEFLY_ON_GROUND = 0,
  GATEFLY_TAKE_OFF = 1,
  GATEFLY_STRAIGHT = 2,
  GATEFLY_TURN = 3,
  GATEFLY_SEARCH = 4,
  GATEFLY_LAND = 5,
  GATEFLY_LANDED = 6
};

/** Why a flight was given up: gatefly_state.abort_reason. */
enum {
  GATEFLY_NOT_ABORTED = 0,
  GATEFLY_GATE_NOT_FOUND = 1,
  GATEFLY_NO_CLIMB = 2,
  GATEFLY_UPSET = 3,
  GATEFLY_SENSORS_LOST = 4,
  GATEFLY_NO_PICTURES = 5
};

/** What the pilot believes; for logs and displays. */
typedef struct gatefly_state {
  uint32_t struct_size;      /**< sizeof(gatefly_state), set by the caller. */
  uint32_t phase;            /**< GATEFLY_ON_GROUND ... GATEFLY_LANDED */
  uint32_t abort_reason;     /**< GATEFLY_NOT_ABORTED ... */
  uint32_t finished;         /**< 1: every gate of every lap is passed. */
  uint32_t gates_passed;     /**< Of all laps. */
  uint32_t target_gate;      /**< Flown to, from 0. */
  uint64_t time_us;          /**< Of the last step, unwrapped. */
  double position_m[3];      /**< Earth axes. */
  double velocity_mps[3];    /**< Earth axes. */
  double attitude_rad[3];    /**< Roll, pitch, yaw. */
  double gate_position_m[3]; /**< Seen from the target gate: x < 0 before it, y right, z down. */
  double gate_sigma_m[3];    /**< How sure that is, one standard deviation each. */
  double gyro_bias_radps[3]; /**< As found; subtracted already from what is flown by. */
  double accel_bias_mps2[3]; /**< The same. */
} gatefly_state;

/** Bits of gatefly_health.problems: what is wrong now. */
enum {
  GATEFLY_PROBLEM_IMU = 1,      /**< No usable sample for 0.1 s of the stamps. */
  GATEFLY_PROBLEM_CLOCK = 2,    /**< The last sample's stamp was refused. */
  GATEFLY_PROBLEM_IMAGE = 4,    /**< In flight, and no picture for 0.25 s. */
  GATEFLY_PROBLEM_DIVERGED = 8, /**< The filter's own residuals say that it is lost. */
  GATEFLY_PROBLEM_ABORTED = 16  /**< Given up: see gatefly_state.abort_reason. */
};

/** What has arrived, and what of it could not be used; counts since creation. */
typedef struct gatefly_health {
  uint32_t struct_size;      /**< sizeof(gatefly_health), set by the caller. */
  uint32_t problems;         /**< GATEFLY_PROBLEM_... now; 0: none. */
  uint64_t steps;            /**< Of the pilot. */
  uint64_t imu_not_finite;   /**< Samples with NaN or infinity: the last one went on. */
  uint64_t imu_out_of_range; /**< Samples of 100 rad/s or 400 m/s^2 and more: the same. */
  uint64_t imu_stale;        /**< Samples not later than the one before, or after a jump. */
  uint64_t clock_jumps;      /**< So often the IMU's clock was followed to another time. */
  uint64_t clock_wraps;      /**< So often 32 bits were full. */
  uint64_t heights;          /**< Given to the pilot: sonar and barometer. */
  uint64_t heights_refused;
  uint64_t images;           /**< Given to the pilot. */
  uint64_t images_refused;   /**< Wrong size, stale. */
  uint64_t images_overtaken; /**< A later one came before the next step. */
  uint64_t since_imu_us;     /**< From the last usable sample to the last step. */
  uint64_t since_image_us;   /**< From the last picture to the last step; all of it without any. */
} gatefly_health;

/** How a picture's bytes are laid out, line by line without padding. */
typedef uint32_t gatefly_format;
enum {
  GATEFLY_UYVY = 0,  /**< YUV 4:2:2, 2 bytes a pixel: U Y0 V Y1. Full range, grey is 128. */
  GATEFLY_RGB = 1,   /**< 3 bytes a pixel. */
  GATEFLY_YUV444 = 2 /**< 3 bytes a pixel: Y, Cb, Cr. */
};

/** GATEFLY_ABI of the library that is linked; another one than the header's must not be used. */
GATEFLY_API uint32_t gatefly_abi(void);
/** "0.2.0": of the library that is linked. */
GATEFLY_API const char* gatefly_version(void);
/** A status in words, for messages. */
GATEFLY_API const char* gatefly_status_text(gatefly_status status);

/** Bytes that gatefly_create() needs of the caller, whatever their alignment. */
GATEFLY_API size_t gatefly_size(void);

/**
 * Makes a pilot and plans its course. The only call that takes long (up to seconds) and allocates:
 * of what depends on the course, beside `memory`.
 *
 * @param memory      at least gatefly_size() bytes, which must stay where they are until
 *                    gatefly_destroy(); or NULL: allocated, too.
 * @param size        of memory; 0 with NULL.
 * @param pilot       set; NULL when it could not be made.
 * @param error       gets one line, ending in 0, saying what is wrong; "" when nothing is. May be
 *                    NULL.
 * @param error_size  of error; longer texts are cut.
 * @return            GATEFLY_OK, _NULL, _WRONG_SIZE, _NO_MEMORY, _WRONG_SETUP, _INTERNAL
 */
GATEFLY_API gatefly_status gatefly_create(void* memory, size_t size, const gatefly_setup* setup,
                                          gatefly_pilot** pilot, char* error, size_t error_size);
/** Ends a pilot and frees what its creation allocated; NULL is let be. */
GATEFLY_API void gatefly_destroy(gatefly_pilot* pilot);

/**
 * One step: an IMU sample, with what was pushed since the last one. Call it for every sample, in order.
 *
 * `command` is written in any case but GATEFLY_NULL, _WRONG_SIZE and _INTERNAL. A sample that is no
 * number, or out of range, still is a step: the pilot goes on with the last one, and lands when that
 * lasts (control.imu_timeout_ms); it switches the motors off where it commands them itself, as nothing
 * levels the drone then. So it does in flight when samples stay the same, bit for bit, for 0.1 s. One
 * with a stale stamp is no step: the command stays. A clock that has jumped (back, or by more than 0.5 s) is followed after three samples in a row that agree;
 * the pilot's own time goes on without a jump.
 *
 * @param time_us     when it was taken.
 * @param gyro_radps  turn rates about x, y, z.
 * @param accel_mps2  specific force.
 * @return            GATEFLY_OK, _NOT_FINITE, _OUT_OF_RANGE, _STALE, _NULL, _WRONG_SIZE
 */
GATEFLY_API gatefly_status gatefly_step(gatefly_pilot* pilot, uint32_t time_us,
                                        const double gyro_radps[3], const double accel_mps2[3],
                                        gatefly_command* command);

/**
 * The estimator's own IMU sample, an autopilot's, where the configuration says so (filter.imu_hz); else
 * without effect. For the next step.
 */
GATEFLY_API gatefly_status gatefly_push_navigation_imu(gatefly_pilot* pilot, uint32_t time_us,
                                                       const double gyro_radps[3],
                                                       const double accel_mps2[3]);
/** The distance to what is below, along the body's z: sonar, lidar; for the next step. @param range_m in (0, 100) */
GATEFLY_API gatefly_status gatefly_push_sonar(gatefly_pilot* pilot, uint32_t time_us,
                                              double range_m);
/** The height above the pad, positive up, by pressure; for the next step. @param height_m within 1000 */
GATEFLY_API gatefly_status gatefly_push_baro(gatefly_pilot* pilot, uint32_t time_us,
                                             double height_m);

/**
 * A picture, for the next step, which looks at it. Its bytes must stay until then; nothing copies them.
 *
 * @param time_us  when it arrived, on the IMU's clock; exposed camera.latency_ms before, as the
 *                 configuration says.
 * @param bytes    width x height pixels as the camera stores them; camera.stored_rotation_deg turns
 *                 them.
 * @param size     of bytes.
 */
GATEFLY_API gatefly_status gatefly_push_image(gatefly_pilot* pilot, uint32_t time_us,
                                              gatefly_format format, uint32_t width,
                                              uint32_t height, const uint8_t* bytes, size_t size);

/**
 * For the next step: another pilot flies, and this one looks on (a flight by hand, a replay).
 *
 * @param lifted        1: that one has taken off.
 * @param motors_radps  four rotor speeds that it commanded, or NULL: not known.
 */
GATEFLY_API gatefly_status gatefly_look_on(gatefly_pilot* pilot, int lifted,
                                           const double* motors_radps);

/** The command of the last step; before the first one: motors off. */
GATEFLY_API gatefly_status gatefly_get_command(const gatefly_pilot* pilot,
                                               gatefly_command* command);
/** What the pilot believes after the last step. */
GATEFLY_API gatefly_status gatefly_get_state(const gatefly_pilot* pilot, gatefly_state* state);
/** Counts and problems after the last call. */
GATEFLY_API gatefly_status gatefly_get_health(const gatefly_pilot* pilot, gatefly_health* health);

#ifdef __cplusplus
}
#endif

#endif
